"""Positions explained, as the files that callers rely on: verdict, model, gaps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from sk120stiff.arrays import Index
from sk120stiff.explain.answer.document import (
    borne_out_entry,
    detectable_entries,
    intervals_of,
    micrometres,
    parameter_entry,
    share_entries,
    share_of,
    step_entry,
    suspect_entries,
)
from sk120stiff.explain.answer.saving import replacing_results, write_verdict
from sk120stiff.explain.answer.verdict import (
    BEST_GUESS,
    NEXT_POSES,
    EffectEntry,
    FamilyEntry,
    GapEntry,
    HoldoutEntry,
    NoiseEntry,
    OddsEntry,
    ParameterEntry,
    RemainderEntry,
    RowEntry,
    Verdict,
)
from sk120stiff.explain.findings import sentence_in
from sk120stiff.explain.positions.answer.explained import Explained, Named
from sk120stiff.explain.positions.answer.next_step import next_step_of_positions
from sk120stiff.explain.positions.judge.accounts import HeldOutFile
from sk120stiff.files import csv_text, write_atomically
from sk120stiff.identify import Calibration, known_model
from sk120stiff.identify.positions.residuals.remainder import remainder_entry
from sk120stiff.identify.positions.solve.pose_problem import PoseProblem
from sk120stiff.identify.positions.uncertainty.undetected import beside_not_named
from sk120stiff.identify.positions.words import findings, gap_sentence, unseen
from sk120stiff.measurements import Measurements, write_measurements
from sk120stiff.model import Model, write_model
from sk120stiff.model.predicted import predict_channels, prediction_table

SURE = 1.0 - 1e-9  # the largest probability that is written: no reading makes certain


def verdict_of_positions(answer: Explained) -> Verdict:
    """What was found in positions, in the form of `verdict.json`."""
    final, readings, held = answer.final, answer.readings, answer.heldout
    stated = final.problem.stated_sigma
    entries = _entries(final, unseen(final))
    lengths = bool(len(final.problem.lengths))
    um = micrometres if lengths else _none
    aside = _rows(readings, np.flatnonzero(final.wild))
    return Verdict(
        verdict=answer.verdict,
        effects=[_effect(answer, item, entries) for item in answer.findings],
        parameters=[entries[p.name] for p in final.model.parameters if p.free],
        gap=GapEntry(
            unit="um" if lengths else "urad",
            noise_floor=None if stated is None else stated * 1e6,
            p=answer.chance,
            set_aside=len(aside),
            borne_out=borne_out_entry(None if held is None or not lengths else held.borne_out),
            steps=[
                step_entry(step).model_copy(
                    update={"heldout_mean_distance": micrometres(step.heldout_distance)}
                )
                for step in answer.steps
            ],
        ),
        holdout=None if held is None else _held_out(held, final.problem),
        families=[
            FamilyEntry(name=name, share_um=um(share)) for name, share in answer.families.items()
        ],
        budget=share_entries(answer.budget),
        budget_joints=share_entries(answer.joints_budget),
        springs_share=answer.springs,
        whole_heldout_um=um(answer.whole),
        remainder=RemainderEntry(**remainder_entry(final), where=list(answer.where)),
        probabilities=[
            OddsEntry(name=name, probability=min(p, SURE), kind="marginal", place=None)
            for name, p in sorted(answer.probabilities.items(), key=lambda item: -item[1])
        ],
        where=list(answer.where),
        suspects=suspect_entries(answer.suspects, um),
        best_guess=None if answer.guess is None else BEST_GUESS,
        best_guess_heldout_um=None if answer.guess is None else um(answer.guess_heldout),
        not_named=list(answer.dropped),
        limits=list(answer.limits),
        not_observable=list(answer.hidden),
        frozen=[item.name for item in final.frozen],
        weak_directions=[item.sentence() for item in final.frozen],
        smallest_detectable=detectable_entries(answer.smallest),
        noise=NoiseEntry(
            model=gap_sentence(final), source=_source(final), sigma_um=um(stated), set_aside=aside
        ),
        next_step=next_step_of_positions(answer),
        said=findings(final, readings),
        next_poses=None if answer.following is None else NEXT_POSES,
    )


def _rows(readings: Measurements, rows: Index) -> list[RowEntry]:
    return [RowEntry(pose=readings.pose[k], line=int(readings.line[k])) for k in rows]


def _held_out(found: HeldOutFile, problem: PoseProblem) -> HoldoutEntry:
    """How far the held-out readings are off."""
    ending = "um" if found.unit(problem) == "µm" else "urad"
    sizes = {"rms": found.rms, "rms_of_all": found.rms_of_all, "registered_rms": found.registered}
    return HoldoutEntry(
        **{f"{name}_{ending}": size * 1e6 for name, size in sizes.items()},
        mean_distance_um=found.distance * 1e6 if np.isfinite(found.distance) else None,
        set_aside=_rows(found.readings, np.flatnonzero(found.set_aside)),
        placed_anew=found.anew,
    )


def save_positions(answer: Explained, out: Path, provenance: Mapping[str, str]) -> dict[str, Any]:
    """Write verdict, model and gaps, all in one moment; the content of verdict.json."""
    verdict = verdict_of_positions(answer)
    fitted = _known(answer, answer.final, provenance)
    readings = replace(answer.readings, use=answer.readings.use & ~answer.final.wild)
    predicted = predict_channels(fitted, readings)
    with replacing_results(out):
        write_model(fitted, out / "model.yaml")
        write_atomically(out / "gaps.csv", csv_text(prediction_table(readings, predicted).items()))
        if answer.guess is not None:
            write_model(_known(answer, answer.guess, provenance), out / BEST_GUESS)
        if answer.following is not None:
            write_measurements(answer.following.readings, out / NEXT_POSES)
        return write_verdict(verdict, out)


def _known(answer: Explained, found: Calibration, provenance: Mapping[str, str]) -> Model:
    """The model of a calibration with its uncertainty, that of springs without a name included."""
    own = {each.id for each in found.model.effects}
    wide = beside_not_named(found, [each for each in answer.rigid if each.id not in own])
    return replace(known_model(wide), provenance=dict(provenance))


def _source(final: Calibration) -> str:
    """What tells the noise."""
    if final.problem.stated_sigma is not None:
        return "stated"
    return "unknown" if final.form is None else "smoothness"


def _none(_radians: float | None) -> None:
    """What is no length has no size in µm."""


def _effect(answer: Explained, item: Named, entries: Mapping[str, ParameterEntry]) -> EffectEntry:
    problem = answer.final.problem
    own = [p for p in answer.final.model.parameters if p.effect == item.effect]
    share = share_of(answer.steps, item.effect)
    return EffectEntry(
        name=item.effect.name,
        where=item.effect.where,
        alternatives=list(item.alternatives),
        exact_aliases=list(item.exact),
        probability=min(item.probability, SURE),
        share_um=micrometres(share) if len(problem.lengths) else None,
        parameters=[entries[p.name] for p in own],
        sentence=sentence_in(answer.final.model, item.effect),
        equation=item.effect.equation,
        axes=item.effect.axes,
        evidence={
            "folds_improved": item.gain.folds,
            "folds": answer.linear.folds,
            "heldout_gain": item.share,
            "heldout_gain_weighed": item.gain.share,
            "heldout_gain_errors": item.gain.errors,
            "log_evidence": item.gain.evidence,
        },
    )


def _entries(final: Calibration, reasons: Mapping[str, str]) -> dict[str, ParameterEntry]:
    """Every parameter by its full name."""
    ends, out = intervals_of(final), {}
    for p in final.model.parameters:
        why = reasons.get(p.name) or (None if p.free else "counted in others, see weak_directions")
        plausible = bool(abs(p.internal) <= final.problem.reach(p))
        out[p.name] = parameter_entry(p, why, ends.get(p.name), plausible=plausible)
    return out
