"""What `explain` answers: frozen data, ready to be shown or written."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from sk120stiff.arrays import Array, rms
from sk120stiff.data_checks import place_of, slips_of_rows
from sk120stiff.effects import CATALOGUE, Catalogue, Effect, Options, load_cases_of
from sk120stiff.errors import ToolkitError
from sk120stiff.explain.findings import Apart, Contender, Detectable, Finding, Step, TaskBudget
from sk120stiff.explain.judge.adequacy import Adequacy
from sk120stiff.explain.judge.borne_out import BorneOut
from sk120stiff.explain.judge.budget import error_budget, joint_budget
from sk120stiff.explain.judge.remainder import Remainder
from sk120stiff.identify import Fit, Yardstick, as_seen, far_off, known_together, yardstick
from sk120stiff.measurements import Measurements, NoiseModel
from sk120stiff.model import Share
from sk120stiff.model.predicted import predict_what_holds

if TYPE_CHECKING:
    from sk120stiff.explain.answer.verdict import Outcome, Verdict
    from sk120stiff.show import Report

SLIP_FITS = 3.0  # times the gap of the readings in use, rms, that a mended axis may be off


@dataclass(frozen=True, eq=False)
class Explanation:
    """The whole answer.

    Attributes:
        verdict: See PRODUCT: none, named, ambiguous, outside.
        findings: Named effects in the order in which they were added.
        base, final: Fits of the base model and of the model with the findings.
        steps: The gap step by step.
        noise: The noise model used.
        noise_reasons: What was decided about it beyond the data's own words.
        set_aside: Rows of the readings, masked ones counted, that were treated as outliers.
        readings: What was explained, masked rows included.
        adequacy: Tests of what the final model leaves over.
        remainder: Its size, as model-form error beside the noise.
        unnamed: What fitted but is not named, and why, in sentences.
        notes: What else is told of the named causes, in sentences.
        units: Why units of force or displacement are in doubt, a sentence; None: they are not.
        beyond: What would explain by far the most, were its size to be believed; None: nothing.
        softer: Names in whose place a part that the user put on would do, were it soft enough.
        limits: How the user limited the search, in sentences; empty if not at all.
        where: Plain statements on where the gap of the base model lives.
        suspects: For verdict ``outside``: what comes nearest.
        guess: For verdict ``outside``: the fit with what foretells other poses best, confirmed or
            not; None if nothing does.
        odds: Probability of one effect more, for each candidate above a hundredth.
        not_observable: Effects that these readings cannot show at any plausible size.
        smallest_detectable: For every parameter of the catalogue what would have shown.
        next_poses: (K, n) coordinates and (K, 6) wrenches to measure next, or None.
        next_pairs: Which names these tell apart, and how far.
        catalogue: The effects that were considered.
        borne_out: What a hold-out file shows of what was named; None where there is none.
        task: What moves the tool on a given task, where one was asked for.
        details: Further figures for reports.

    Examples:
        >>> import sk120stiff as sk
        >>> data = sk.bundled_robots()["motoman_sk120"] / "data"
        >>> readings = sk.read(data / "table2_measured.csv")
        >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
        >>> sk.explain(model, readings, options=sk.Options(only=("joint_tilt",)))
        <Explanation: none; gap 17.2 µm rms>
    """

    verdict: Outcome
    findings: tuple[Finding, ...]
    base: Fit
    final: Fit
    steps: tuple[Step, ...]
    noise: NoiseModel
    noise_reasons: tuple[str, ...]
    set_aside: tuple[int, ...]
    readings: Measurements
    adequacy: Adequacy
    remainder: Remainder
    unnamed: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    units: str | None = None
    beyond: str | None = None
    softer: tuple[str, ...] = ()
    limits: tuple[str, ...] = ()
    where: tuple[str, ...] = ()
    suspects: tuple[Contender, ...] = ()
    guess: Fit | None = None
    odds: Mapping[str, float] = field(default_factory=dict)
    not_observable: tuple[str, ...] = ()
    smallest_detectable: tuple[Detectable, ...] = ()
    next_poses: tuple[Array, Array] | None = None
    next_pairs: tuple[Apart, ...] = ()
    catalogue: Catalogue = CATALOGUE
    borne_out: BorneOut | None = None
    task: TaskBudget | None = None
    details: Mapping[str, Any] = field(default_factory=dict)

    @cached_property
    def yardstick(self) -> Yardstick:
        """The noise that all gaps are held against, on every page and in every file."""
        return yardstick(self.final)

    @property
    def noise_floor(self) -> float | None:
        """Rms per axis that noise alone would give the gap [m]; None where nothing tells it."""
        return self.yardstick.floor

    @cached_property
    def known_together(self) -> tuple[str, ...]:
        """What of the named effects only shows together with others, in sentences."""
        return known_together(self.final, {finding.effect.id for finding in self.findings})

    @cached_property
    def budget(self) -> tuple[Share, ...]:
        """What each effect moves the point by at the measured loads, the largest first."""
        return error_budget(self.final)

    @cached_property
    def joints_budget(self) -> tuple[Share, ...]:
        """What spring, gear and bearing of each joint move the point by together."""
        return joint_budget(self.final)

    @property
    def far_off(self) -> tuple[tuple[str, float], ...]:
        """Readings far off the model that were not set aside, the worst first, and by how much [m].

        Where nothing has a name: a cause that has none may have made them.
        """
        if self.findings:
            return ()
        readings, size = self.final.problem.measurements, np.sqrt(np.nansum(self.final.gap**2, 1))
        rows = sorted(far_off(self.final).tolist(), key=lambda row: -float(size[row]))
        return tuple((place_of(readings, row), float(size[row])) for row in rows)

    @cached_property
    def slips(self) -> Mapping[int, str]:
        """The slip of the pen that would explain a row that was set aside, where one would."""
        if not self.set_aside:
            return {}
        final = self.final.model
        limit = SLIP_FITS * max(self.steps[-1].fit_rms, self.noise_floor or 0.0)
        try:
            told = predict_what_holds(final, load_cases_of(final.robot, self.readings))
        except ToolkitError:
            return {}
        return slips_of_rows(self.readings, self.set_aside, told.displacement, limit)

    @cached_property
    def rms_of_all(self) -> float:
        """Gap of the final model over all readings in use, those set aside among them [m]."""
        if not self.set_aside:
            return self.final.rms
        problem = self.final.problem
        used = as_seen(self.final.model.robot, self.readings).masked()
        gap = replace(problem, measurements=used, weights=None).gap(self.final.x)
        return rms(gap)

    def effect(self, name: str) -> Effect:
        """The effect ``name:where`` of the catalogue, as it was considered.

        Examples:
            >>> import sk120stiff as sk
            >>> data = sk.bundled_robots()["motoman_sk120"] / "data"
            >>> readings = sk.read(data / "table2_measured.csv")
            >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
            >>> answer = sk.explain(model, readings, options=sk.Options(only=("joint_tilt",)))
            >>> answer.effect("joint_tilt:joint_2_l").sentence()
            'The bearing of joint_2_l tilts about the axes normal to its joint axis.'
        """
        readings = self.base.problem.measurements
        kind, _, where = name.partition(":")
        told = Options(poses=readings.poses, timed=readings.time is not None)
        return self.catalogue.effect(self.base.model.robot, kind, where, told)

    def next_readings(self) -> Measurements | None:
        """The poses and loads that would tell the names apart, as a plan; None: none are needed.

        Examples:
            >>> import sk120stiff as sk
            >>> folder = sk.bundled_robots()["motoman_sk120"] / "data"
            >>> readings = sk.read(folder / "table2_measured.csv")
            >>> answer = sk.explain(sk.base_model(sk.load_robot("motoman_sk120")), readings)
            >>> answer.next_readings() is None  # nothing is missing that needs a name
            True
        """
        from sk120stiff.explain.answer.saving import plan_of

        return None if self.next_poses is None else plan_of(self, self.readings)

    def document(self) -> Verdict:
        """What `verdict.json` says, as an object: all numbers, probabilities and sentences.

        Examples:
            >>> import sk120stiff as sk
            >>> data = sk.bundled_robots()["motoman_sk120"] / "data"
            >>> readings = sk.read(data / "table2_measured.csv")
            >>> answer = sk.explain(sk.base_model(sk.load_robot("motoman_sk120")), readings)
            >>> found = answer.document()
            >>> found.verdict, found.gap.unit, found.remainder.significant
            ('none', 'um', False)
        """
        from sk120stiff.explain.answer.document import verdict_of

        return verdict_of(self)

    def save(
        self, folder: str | os.PathLike[str], *, provenance: Mapping[str, str] | None = None
    ) -> dict[str, object]:
        """Write verdict.json, model.yaml, gaps.csv, and next_poses.csv where poses would tell more.

        Files of an earlier answer in the folder are replaced, pages too, all in one moment. The
        report is `report`.

        Args:
            folder: Made where it is missing.
            provenance: Where the readings come from, for the model's file.

        Returns:
            dict: The content of verdict.json.

        Examples:
            >>> import sk120stiff as sk
            >>> data = sk.bundled_robots()["motoman_sk120"] / "data"
            >>> readings = sk.read(data / "table2_measured.csv")
            >>> import tempfile
            >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
            >>> answer = sk.explain(model, readings, options=sk.Options(only=("joint_tilt",)))
            >>> with tempfile.TemporaryDirectory() as folder:
            ...     written = answer.save(folder)
            >>> written["verdict"], written["schema"]
            ('none', 2)
        """
        from sk120stiff.explain.answer.saving import save

        return save(self, folder, provenance=provenance)

    def report(self, file: str | os.PathLike[str] | None = None, **told: Any) -> Report:
        """The report that `sk120stiff explain` writes, with its figures and the 3-D scene.

        A notebook shows it as it is; ``.html()`` is its text and ``.write(file)`` writes it.

        Args:
            file: Where to write it: one HTML file that opens offline. None: nowhere.
            told: What it may be told beside the answer, see `show.stories.explain_report`, such as
                ``data="my arm"`` or ``scene=""`` for a report without a scene.

        Raises:
            MissingPart: What draws pictures is not installed.

        Examples:
            >>> import sk120stiff as sk
            >>> folder = sk.bundled_robots()["motoman_sk120"] / "data"
            >>> readings = sk.read(folder / "table2_measured.csv")
            >>> answer = sk.explain(sk.base_model(sk.load_robot("motoman_sk120")), readings)
            >>> answer.report(scene="").subtitle
            'motoman_sk120, 15 readings at 3 poses, `table2_measured.csv`'
        """
        from sk120stiff.show import reproducibility, scene_html
        from sk120stiff.show.stories import explain_report, explain_scene

        path = self.readings.path
        told.setdefault("data", "" if path is None else path.name)
        if "scene" not in told:
            told["scene"] = scene_html(explain_scene(self, subtitle=told["data"]))
        if "reproducibility" not in told:
            told["reproducibility"] = reproducibility("Explanation.report", [path] if path else [])
        report = explain_report(self, self.readings, **told)
        if file is not None:
            report.write(file)
        return report

    def __repr__(self) -> str:
        names = ", ".join(finding.effect.id for finding in self.findings)
        first, last = self.steps[0].fit_rms * 1e6, self.steps[-1].fit_rms * 1e6
        gap = f"{first:.3g} → {last:.3g}" if self.findings else f"{first:.3g}"
        return f"<Explanation: {self.verdict}{' ' if names else ''}{names}; gap {gap} µm rms>"

    def _repr_html_(self) -> str:
        """What a notebook shows: the first lines of the report, sizes and gap."""
        from sk120stiff.show.stories.explain_report import summary_html

        return summary_html(self)
