"""An explanation of displacements in the form of `verdict.json`; positions share its entries."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict
from itertools import pairwise

import numpy as np

from sk120stiff.effects import Effect
from sk120stiff.explain.answer.explanation import Explanation
from sk120stiff.explain.answer.next_step import next_step
from sk120stiff.explain.answer.probabilities import probabilities
from sk120stiff.explain.answer.sizes import whole_size
from sk120stiff.explain.answer.verdict import (
    BEST_GUESS,
    NEXT_POSES,
    AdequacyEntry,
    BorneOutEntry,
    DetectableEntry,
    EffectEntry,
    GapEntry,
    GoesWithEntry,
    NoiseEntry,
    OddsEntry,
    PairEntry,
    ParameterEntry,
    RemainderEntry,
    RowEntry,
    ShareEntry,
    SizeEntry,
    StepEntry,
    SuspectEntry,
    TaskEntry,
    Verdict,
)
from sk120stiff.explain.answer.words import noise_words
from sk120stiff.explain.findings import (
    Contender,
    Detectable,
    Finding,
    Step,
    TaskBudget,
    sentence_in,
)
from sk120stiff.explain.judge.borne_out import BorneOut
from sk120stiff.explain.judge.goes_with import GoesWith
from sk120stiff.identify import Fit, unseen_reasons
from sk120stiff.identify.report import noise_sentence
from sk120stiff.model import Parameter, Share

RIGID = "it lies on its bound: rigid fits best"


def verdict_of(answer: Explanation) -> Verdict:
    """What was found in displacements, in the form of `verdict.json`."""
    readings, slips = answer.readings, answer.slips
    return Verdict(
        verdict=answer.verdict,
        remainder=_remainder(answer),
        probabilities=[OddsEntry(**asdict(each)) for each in probabilities(answer)],
        effects=[_effect(answer, finding) for finding in answer.findings],
        parameters=parameters_before_and_after(answer),
        gap=GapEntry(
            unit="um",
            noise_floor=micrometres(answer.noise_floor),
            p=answer.adequacy.chance,
            rms_of_all=micrometres(answer.rms_of_all),
            set_aside=len(answer.set_aside),
            steps=[step_entry(step) for step in answer.steps],
            borne_out=borne_out_entry(answer.borne_out),
        ),
        next_step=next_step(answer),
        budget=share_entries(answer.budget),
        budget_joints=share_entries(answer.joints_budget),
        budget_task=_task(answer.task),
        units=answer.units,
        where=list(answer.where),
        suspects=suspect_entries(answer.suspects),
        best_guess=BEST_GUESS if answer.guess is not None else None,
        notes=list(answer.notes),
        not_named=list(answer.unnamed),
        known_together=list(answer.known_together),
        limits=list(answer.limits),
        noise=NoiseEntry(
            model=noise_sentence(answer.final),
            source=answer.yardstick.source,
            sigma_um=micrometres(answer.yardstick.sigma),
            degrees_of_freedom=answer.yardstick.freedom,
            growth=answer.noise.growth,
            force=answer.noise.force,
            decided=list(noise_words(answer)),
            set_aside=[
                RowEntry(pose=readings.pose[row], line=int(readings.line[row]), slip=slips.get(row))
                for row in answer.set_aside
            ],
        ),
        adequacy=AdequacyEntry(
            probability=answer.adequacy.probability,
            left_over=answer.adequacy.excess,
            explained=answer.adequacy.explained,
            tests=dict(answer.adequacy.tests),
            understated=answer.adequacy.understated,
        ),
        not_observable=list(answer.not_observable),
        smallest_detectable=detectable_entries(answer.smallest_detectable),
        next_poses=None if answer.next_poses is None else NEXT_POSES,
        next_pairs=[PairEntry(**asdict(p), settled=p.settled) for p in answer.next_pairs],
    )


def borne_out_entry(found: BorneOut | None) -> BorneOutEntry | None:
    """What a hold-out file shows of what was named."""
    if found is None:
        return None
    return BorneOutEntry(
        file=found.file,
        rms_um=micrometres(found.gap),
        without_um=micrometres(found.without),
        share=found.share,
        std=found.std,
        poses=found.poses,
        contradicted=found.contradicted,
    )


def step_entry(step: Step) -> StepEntry:
    """The gap with one effect more in the model [µm]."""
    return StepEntry(
        model=step.label, fit_rms=step.fit_rms * 1e6, heldout_rms=step.heldout_rms * 1e6
    )


def _remainder(answer: Explanation) -> RemainderEntry:
    """What is left beyond the noise."""
    left = answer.remainder
    low, high = left.interval
    return RemainderEntry(
        rms_um=micrometres(left.rms),
        interval_95=(micrometres(low), micrometres(high)),
        p=left.probability,
        significant=left.significant,
        proportional=left.form.proportional,
        constant_um=micrometres(left.form.constant),
        where=list(left.where),
        goes_with=None if left.goes_with is None else _goes_with(left.goes_with),
    )


def _goes_with(place: GoesWith) -> GoesWithEntry:
    """What the remainder goes with, and how near other readings are foretold with it."""
    foretold = place.foretold
    return GoesWithEntry(
        name=place.suspect,
        left_um=micrometres(place.left),
        foretold_um=None if foretold is None else micrometres(foretold.gap),
        foretold_without_um=None if foretold is None else micrometres(foretold.without),
    )


def _task(task: TaskBudget | None) -> TaskEntry | None:
    """The budget of a task; None where none was asked for."""
    if task is None:
        return None
    return TaskEntry(
        path=task.path,
        points=task.points,
        effects=share_entries(task.effects),
        joints=share_entries(task.joints),
    )


def share_entries(shares: Iterable[Share], size: float = 1.0) -> list[ShareEntry]:
    """Shares of a budget in µm, `size` times their rms per axis; of sums with their members."""
    return [
        ShareEntry(
            name=share.name,
            members=list(share.members),
            rms_um=micrometres(size * share.rms),
            std_um=None if share.std is None else micrometres(size * share.std),
        )
        for share in shares
    ]


def suspect_entries(
    suspects: Iterable[Contender], um: Callable[[float], float | None] | None = None
) -> list[SuspectEntry]:
    """What came nearest where nothing is confirmed."""
    um = um or micrometres
    return [SuspectEntry(name=each.id, heldout_gain_um=um(each.heldout_gain)) for each in suspects]


def detectable_entries(smallest: Iterable[Detectable]) -> list[DetectableEntry]:
    """The smallest sizes that would have been named."""
    return [DetectableEntry(**asdict(item)) for item in smallest]


def share_of(steps: Sequence[Step], effect: Effect) -> float | None:
    """By how much the held-out gap fell when an effect joined alone [m]; None where it did not."""
    for before, step in pairwise(steps):
        if step.joined == (effect.id,):
            return before.heldout_rms - step.heldout_rms
    return None


def micrometres(metres: float | None) -> float | None:
    """A length for people; null where there is none."""
    return None if metres is None or not np.isfinite(metres) else metres * 1e6


def parameters_before_and_after(answer: Explanation) -> list[ParameterEntry]:
    """All parameters of the final model, with the base model's estimate of each."""
    before = {p.name: p for p in answer.base.model.parameters}
    unseen = unseen_reasons(answer.final)
    hidden = unseen_reasons(answer.base)
    ends = intervals_of(answer.final)
    return [
        parameter_entry(
            p,
            unseen.get(p.name),
            ends.get(p.name),
            before=before[p.name].value if p.name in before and p.name not in hidden else None,
        )
        for p in answer.final.model.parameters
    ]


def _effect(answer: Explanation, finding: Finding) -> EffectEntry:
    found = [p for p in answer.final.model.parameters if p.effect == finding.effect]
    evidence, whole = finding.evidence, whole_size(answer, finding)
    unseen, ends = unseen_reasons(answer.final), intervals_of(answer.final)
    return EffectEntry(
        name=finding.effect.name,
        where=finding.effect.where,
        alternatives=list(finding.alternatives),
        exact_aliases=list(finding.exact),
        probability=finding.probability,
        share_um=micrometres(share_of(answer.steps, finding.effect)),
        parameters=[parameter_entry(p, unseen.get(p.name), ends.get(p.name)) for p in found],
        size=None if whole is None else SizeEntry(**asdict(whole)),
        sentence=sentence_in(answer.final.model, finding.effect),
        equation=finding.effect.equation,
        axes=finding.effect.axes,
        evidence={
            "delta_bic": evidence.score_gain,
            "delta_chi_square": evidence.misfit_gain,
            "runner_up": evidence.runner_up,
            "runner_up_delta_bic": evidence.runner_up_gap,
            "folds_improved": evidence.confirmation.folds_improved,
            "folds": evidence.confirmation.folds,
            "heldout_gain": evidence.confirmation.gain,
            "heldout_gain_std": evidence.confirmation.gain_error,
            "folds_count": evidence.confirmation.foretells,
            "name_frequency": evidence.confirmation.frequency,
            "rival_frequency": evidence.confirmation.rival_frequency,
        },
    )


def intervals_of(fit: Fit) -> dict[str, tuple[float, float]]:
    """95 % intervals by the parameters' full names, as wide on each side as the readings say."""
    return dict(zip((p.name for p in fit.parameters), fit.intervals(), strict=True))


def parameter_entry(
    p: Parameter,
    unseen: str | None = None,
    ends: tuple[float, float] | None = None,
    *,
    before: float | None = None,
    plausible: bool | None = None,
) -> ParameterEntry:
    """Value, error and interval; null, with the reason, for what the readings do not show.

    The interval is made in compliances, where the readings are linear: of a stiffness that is
    hardly known it is lopsided, and open where rigid is not excluded.
    """
    shown = unseen is None
    return ParameterEntry(
        name=p.name,
        value=p.value if shown else None,
        std=p.std if shown else None,
        interval_95=ends if shown else None,
        unit=p.spec.unit,
        meaning=p.spec.meaning,
        internal_value=p.internal if shown else None,
        internal_std=p.internal_std if shown else None,
        internal_unit=p.spec.internal_unit,
        reason=unseen or p.note or (RIGID if np.isinf(p.value) else None),
        before=before,
        plausible=plausible,
    )
