"""What `explain` answers of positions: frozen data, ready to be shown or written."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy import stats

from sk120stiff.effects import Effect
from sk120stiff.errors import micro, two_digits
from sk120stiff.explain.findings import Contender, Detectable, likely
from sk120stiff.explain.judge.budget import internal_covariance
from sk120stiff.explain.positions.advise.other_poses import NextPoses
from sk120stiff.explain.positions.judge.accounts import GapStep, HeldOutFile
from sk120stiff.explain.positions.judge.budget import budget_of
from sk120stiff.explain.positions.select.choose import Gain
from sk120stiff.explain.positions.select.linear import Linear
from sk120stiff.identify import Calibration
from sk120stiff.identify.positions.residuals.remainder import LEVEL, Size, remainder_sentences
from sk120stiff.identify.positions.words import unseen
from sk120stiff.measurements import Measurements
from sk120stiff.model import Share

if TYPE_CHECKING:
    from sk120stiff.explain.answer.verdict import Outcome, Verdict
    from sk120stiff.show import Report

SURE = 0.95  # probability of a name that is settled
HARDLY = 0.01  # probability of an alternative below which it has no line of its own
SEEN = 2.0  # standard errors from which on a value is known by itself
LEAST = 5e-4  # share of the gap that is nothing
ROUNDED = 0.01  # of a sum of probabilities that are told by two digits each
APART = 0.05  # share by which the gap to first order may be another than the exact one, untold


@dataclass(frozen=True)
class Named:
    """One named cause.

    Attributes:
        effect: The effect.
        alternatives: What explains as much here.
        exact: Those of the alternatives that explain as much at every pose.
        probability: Of the effect or one of its alternatives.
        gain: What poses left out say of it, as the readings weigh.
        share: What it takes off the gap at poses left out beside the others, of what is left
            without it.
        untold: Those of the exact ones that are another thing to mend, and that something else than
            such readings tells from it.
    """

    effect: Effect
    alternatives: tuple[str, ...]
    exact: tuple[str, ...]
    probability: float
    gain: Gain
    share: float
    untold: tuple[str, ...] = ()

    @property
    def others(self) -> tuple[str, ...]:
        """Alternatives that other poses could tell from it."""
        return tuple(name for name in self.alternatives if name not in self.exact)

    @property
    def same(self) -> tuple[str, ...]:
        """Alternatives that nothing tells from it."""
        return tuple(name for name in self.exact if name not in self.untold)

    @property
    def settled(self) -> bool:
        """One name, or one class of names, is sure enough, and nothing could tell more."""
        return not self.others and not self.untold and self.probability >= SURE

    def kind_of(self, other: str) -> str:
        """Why one of the alternatives stands beside the name, in words."""
        if other in self.untold:
            return "no pose tells them apart"
        return "always the same" if other in self.exact else "not told apart here"


@dataclass(frozen=True, eq=False, repr=False)
class Explained:
    """What is missing where positions were read.

    Attributes:
        verdict: none, named, ambiguous or outside.
        findings: Causes in the order in which they joined.
        base, final: Calibrations without them and with them.
        linear: The positions linearised at the last fit but one, the base beside which all others
            are judged.
        steps: The gap step by step.
        families: Family → rms per axis that its causes take off the held-out gap together [m].
        springs: What springs in all joints would take off the held-out gap beside the named causes,
            as a share of it; None where they are named, or nothing bends the arm.
        whole: Rms that all errors of geometry and all springs together, none of them named, leave
            at poses left out, where that is clearly less than the model leaves [m]; else None.
        dropped: What fitted and is not named, in sentences.
        hidden: Candidates that do not show in these positions at all.
        rigid: Springs of drives that were looked for and not named.
        remainder: Rms per axis that is left beyond the noise, and its 95 % interval [m]; None: no
            noise is stated, and what is left may be noise.
        chance: Probability of as large a misfit if the noise were all; None as before.
        suspects: Where nothing is confirmed: names that fit, and what they take off the held-out
            rms [m].
        guess: The calibration with these.
        guess_heldout: Rms that it leaves at poses left out [m].
        where: Where what is left lives, in sentences.
        smallest: Sizes that would have been named beside the named causes.
        probabilities: Name → probability of its being at work, of all that have one worth telling.
        following: Readings that would tell the first open pair of names apart, or None.
        readings: What was explained, masked rows included.
        heldout: The gap at readings kept out of everything; None where there were none.
        moved: What was taken as moved in the middle of the campaign, in sentences.
        limits: How the user limited the search, in sentences; empty if not at all.
        off_level: That the arm sags to another side than its file says, in a sentence if so.
    """

    verdict: Outcome
    findings: tuple[Named, ...]
    base: Calibration
    final: Calibration
    linear: Linear
    steps: tuple[GapStep, ...]
    families: dict[str, float]
    springs: float | None
    whole: float | None
    dropped: tuple[str, ...]
    hidden: tuple[str, ...]
    rigid: tuple[Effect, ...]
    remainder: Size | None
    chance: float | None
    suspects: tuple[Contender, ...]
    guess: Calibration | None
    guess_heldout: float
    where: tuple[str, ...]
    smallest: tuple[Detectable, ...]
    probabilities: dict[str, float]
    following: NextPoses | None
    readings: Measurements
    heldout: HeldOutFile | None = None
    moved: tuple[str, ...] = ()
    limits: tuple[str, ...] = ()
    off_level: tuple[str, ...] = ()

    def __repr__(self) -> str:
        names = ", ".join(item.effect.id for item in self.findings)
        first, last = (1e6 * self.steps[k].fit_rms for k in (0, -1))
        gap = f"{first:.3g} → {last:.3g}" if self.findings else f"{first:.3g}"
        said = f"{self.verdict} {names}".rstrip()
        return f"<Explained: {said}; gap {gap} {self.final.problem.unit} rms>"

    @cached_property
    def _budgets(self) -> tuple[tuple[Share, ...], tuple[Share, ...]]:
        return budget_of(self.final)

    @property
    def budget(self) -> tuple[Share, ...]:
        """What each effect moves the marker by at the readings, the largest first."""
        return self._budgets[0]

    @property
    def joints_budget(self) -> tuple[Share, ...]:
        """What spring, gear and bearing of each joint move it by together."""
        return self._budgets[1]

    @property
    def displaced(self) -> bool:
        """Was only what a load does read, and not where things stand?"""
        return self.final.problem.channels.displacements_alone

    @property
    def lacking(self) -> bool:
        """More is left than the noise makes."""
        return self.chance is not None and self.chance < LEVEL

    def chance_of(self, item: Named) -> str:
        """How probable a name is, and where others explain as much how probable one of them is."""
        if not item.alternatives:
            return likely(item.probability)
        own = likely(self.probabilities.get(item.effect.id, 0.0))
        return f"{own}; it or one of those not told from it: {likely(item.probability)}"

    def rival(self, item: Named, other: str) -> str:
        """Why one of the alternatives stands beside a name, and how probable it is."""
        own, its = (self.probabilities.get(name, 0.0) for name in (item.effect.id, other))
        more = ", more than of the one that model.yaml has" if its > own + ROUNDED else ""
        return f"{item.kind_of(other)}; {likely(its)}{more}"

    def sums(self) -> tuple[str, ...]:
        """Why probabilities of names that are not told apart add up to more, in a sentence."""
        chance = self.probabilities
        for item in self.findings:
            names = item.effect.id, *item.alternatives
            if sum(chance.get(name, 0.0) for name in names) > item.probability + ROUNDED:
                return (
                    "Names that are not told apart may be at work together: then their "
                    "probabilities add up to more than that of one of them at least.",
                )
        return ()

    def rivals_of(self, item: Named) -> tuple[list[str], list[str]]:
        """Alternatives of a name that are worth a line each, and those that are hardly likely."""
        faint = [
            other
            for other in item.alternatives
            if other not in item.same and self.probabilities.get(other, 0.0) < HARDLY
        ]
        if len(faint) < 2:
            faint = []
        return [other for other in item.alternatives if other not in faint], faint

    def taken_off(self, item: Named, of: str = "") -> str:
        """What a name takes off the gap at poses left out, `of` behind it, in words."""
        hidden = unseen(self.final)
        held = zip(self.final.parameters, self.final.at_bound, strict=True)
        own = [(p.name in hidden, bool(at)) for p, at in held if p.effect == item.effect]
        said = f"takes off {100 * item.share:.1f} %{of}"
        if own and all(unknown for unknown, _ in own):
            return f"{said} together with errors of geometry, from which its size is not told"
        if own and all(at for _, at in own):
            return f"alone {said}; beside the others its value comes out as nothing"
        weighed, rest = "", item.gain.share
        if self.final.problem.common and item.share < LEAST < rest:
            weighed = (
                f"; it takes off {100 * rest:.1f} % where readings count less for what all of a "
                "pose have in common"
            )
        if abs(item.share) < LEAST:
            return f"takes nothing off{of} beside the others{weighed}"
        if item.share < 0.0:
            return f"beside the others adds {-100 * item.share:.1f} %{of}{weighed}"
        return said

    def only_together(self, item: Named) -> tuple[str, ...]:
        """What is known of a name none of whose values is known by itself, in a sentence."""
        final, hidden = self.final, unseen(self.final)
        free = [
            k for k, p in enumerate(final.model.parameters) if p.effect == item.effect and p.free
        ]
        own = [k for k in free if final.model.parameters[k].name not in hidden]
        values = final.model.values[own]
        covariance = internal_covariance(final)[np.ix_(own, own)]
        errors = np.sqrt(np.diag(covariance))
        known = np.abs(values) > SEEN * errors
        if len(own) < 2 or not np.isfinite(errors).all() or not errors.all() or known.any():
            return ()
        square = float(values @ np.linalg.pinv(covariance, hermitian=True) @ values)
        chance = float(stats.chi2.sf(square, len(own)))
        if chance < LEVEL:
            together = f"together they are (χ² = {square:.3g} on {len(own)} numbers)"
            return (f"None of its values is known by itself, but {together}.",)
        return ("None of its values is known beside all that is fitted here, nor all together.",)

    def shares(self) -> tuple[str, ...]:
        """Why shares of several names add up to more than all, in a sentence."""
        if sum(item.share for item in self.findings) <= 1.0:
            return ()
        return (
            "Each share is of the gap that all other names leave without that one, so they add up "
            "to more than 100 %.",
        )

    def weight(self) -> tuple[str, ...]:
        """What the arm's weight would explain where no spring is named, in a sentence."""
        if self.springs is None:
            return ()
        more = f"{two_digits(100 * self.springs)} % more" if self.springs > 0.0 else "nothing more"
        under = "these loads" if self.displaced else "the arm's weight"
        return (
            f"Springs in all joints under {under} would take {more} off the gap at poses "
            "left out: they are not named.",
        )

    def not_counted(self) -> tuple[str, ...]:
        """What the gap's numbers step by step leave out, or have otherwise, in sentences."""
        said, count = list[str](), int(self.final.wild.sum())
        if count:
            rows = "the row that was" if count == 1 else f"the {count} rows that were"
            said.append(f"Fitted and held-out numbers leave out {rows} set aside.")
        fitted, exact = self.steps[-1].fit_rms, self.final.rms
        if abs(fitted - exact) > APART * exact:
            unit = self.final.problem.unit
            said.append(
                "Step by step the gap is told to first order, with values drawn towards what is "
                f"plausible; fitted exactly the last model leaves {micro(exact, 4)} {unit}."
            )
        if self.final.problem.common and any(
            after.fit_rms > before.fit_rms for before, after in pairwise(self.steps)
        ):
            said.append(
                "The last row weighs readings less for what all of a pose have in common; others, "
                "which nobody fits, as they foretell other poses better. So a gap may grow."
            )
        return tuple(said)

    def left_over(self) -> tuple[str, ...]:
        """What is left beyond the stated noise and where it lives, in sentences."""
        return (*remainder_sentences(self.final), *self.where)

    def next_readings(self) -> Measurements | None:
        """The poses and loads that would tell names apart, as a plan; None: none are needed."""
        return None if self.following is None else self.following.readings

    def document(self) -> Verdict:
        """What `verdict.json` says, as an object; see `Explanation.document`."""
        from sk120stiff.explain.positions.answer.document import verdict_of_positions

        return verdict_of_positions(self)

    def save(
        self, folder: str | os.PathLike[str], *, provenance: Mapping[str, str] | None = None
    ) -> dict[str, Any]:
        """Write verdict.json, model.yaml, gaps.csv; see `Explanation.save`."""
        from sk120stiff.explain.positions.answer.document import save_positions

        return save_positions(self, Path(folder), provenance or {})

    def report(self, file: str | os.PathLike[str] | None = None, **told: Any) -> Report:
        """The report that `sk120stiff explain` writes; see `Explanation.report`."""
        from sk120stiff.show import reproducibility
        from sk120stiff.show.stories import positions_report

        path = self.readings.path
        told.setdefault("data", "" if path is None else path.name)
        if "reproducibility" not in told:
            told["reproducibility"] = reproducibility("Explained.report", [path] if path else [])
        report = positions_report(self, **told)
        if file is not None:
            report.write(file)
        return report
