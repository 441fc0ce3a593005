"""Fit becomes an `Explanation`: search, tell apart, confirm, add, judge what is left."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from sk120stiff.arrays import on_one_thread
from sk120stiff.data_checks import refuse_slips, without_copies, without_stuck, without_wild
from sk120stiff.effects import Catalogue, Effect
from sk120stiff.errors import InputError, Refusal, ToolkitWarning
from sk120stiff.explain.advise.best_guess import contenders
from sk120stiff.explain.advise.consequences import completed
from sk120stiff.explain.answer.explanation import Explanation
from sk120stiff.explain.answer.verdict import Outcome
from sk120stiff.explain.candidates.linearised import Linearised
from sk120stiff.explain.findings import Finding
from sk120stiff.explain.judge.adequacy import Adequacy
from sk120stiff.explain.judge.attribution import Named
from sk120stiff.explain.judge.beside_suspect import Account
from sk120stiff.explain.judge.borne_out import borne_out
from sk120stiff.explain.judge.goes_with import Foretold
from sk120stiff.explain.judge.implausible import implausible
from sk120stiff.explain.judge.judged_names import adequacy_of, judged_names
from sk120stiff.explain.judge.one_gear import WORTH_A_SENTENCE, Imitated, imitated_together
from sk120stiff.explain.judge.posterior import doubted, doubted_findings, one_more
from sk120stiff.explain.judge.remainder import Remainder, remainder_of
from sk120stiff.explain.judge.rigid_gears import held_rigid, without_rigid_gears
from sk120stiff.explain.judge.selection_uncertainty import with_selection_uncertainty
from sk120stiff.explain.judge.soft_parts import with_soft_parts
from sk120stiff.explain.judge.steps import (
    foretold_beside,
    foretold_on_file,
    gap_steps,
    on_poses_left_out,
)
from sk120stiff.explain.localise.changes import changed_at
from sk120stiff.explain.localise.places import localise
from sk120stiff.explain.localise.words import where_sentences
from sk120stiff.explain.options import Options, candidates_for, with_assumed
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.explain.positions.run import explain_positions
from sk120stiff.explain.select.best_selection import (
    Try,
    best_selection,
    held_against,
    of_readings,
)
from sk120stiff.explain.select.brought import (
    brought,
    soft_rivals,
    softer_instead,
    softer_than_customary,
)
from sk120stiff.explain.select.form import beside_form, forms
from sk120stiff.explain.select.own_sizes import with_settled_sizes
from sk120stiff.explain.select.stepwise import Selection, select
from sk120stiff.identify import (
    Fit,
    as_seen,
    axes_of_joint_angles,
    fit,
    gauges_as_displacements,
    refuse_unusable,
)
from sk120stiff.identify.solve.forces import moved_alike, with_by_force
from sk120stiff.identify.uncertainty.compliant_parts import beside_parts
from sk120stiff.identify.uncertainty.parts import mostly_parts
from sk120stiff.measurements import Measurements, NoiseModel, as_displacements, decided
from sk120stiff.measurements import candidates as noise_candidates
from sk120stiff.model import Model

TOLD = 2  # sentences on where the remainder lives

Progress = Callable[[str, float], None]


@on_one_thread
def explain(
    model: Model,
    measurements: Measurements,
    *,
    holdout: Measurements | None = None,
    options: Options | None = None,
    catalogue: Catalogue | None = None,
    progress: Progress | None = None,
) -> Explanation | Explained:
    """Find where model and readings disagree, name what is missing, add it, judge the rest.

    Of absolute readings the answer is an `Explained`, with the same verdicts and methods. Effects
    of the model are taken for granted there: give ``Model(robot)`` to have springs looked for too.
    What gauges alone read are displacements, unless nothing of the model may yield.

    Args:
        model: The base model; its effects are part of every model considered.
        measurements: Readings to be explained.
        holdout: Readings of other poses, kept out of everything; the gap on them is reported.
        options: How the search is steered.
        catalogue: The effects that may be missing, ``CATALOGUE + Mine`` with your own. Default:
            those that the model knows, see `read_model`.
        progress: Called with a phrase and a share of the work done.

    Raises:
        InputError: No readings, too few of them, one pose alone, an effect that does not exist, or
            an option that does nothing for such readings.
        Refusal: The data look written down wrongly, or the base model itself cannot be fitted.

    Examples:
        >>> import sk120stiff as sk
        >>> folder = sk.bundled_robots()["motoman_sk120"] / "data"
        >>> readings = sk.read(folder / "table2_measured.csv")
        >>> answer = sk.explain(sk.base_model(sk.load_robot("motoman_sk120")), readings)
        >>> answer.verdict
        'none'
    """
    measurements, told = without_stuck(measurements)
    if told:
        warnings.warn(told, ToolkitWarning, stacklevel=3)
    measurements = gauges_as_displacements(model, measurements)
    if measurements.absolute is None and holdout is not None:
        holdout = as_displacements(holdout)
    if catalogue is not None:
        model = replace(model, catalogue=catalogue)
    if measurements.absolute is not None:
        if measurements.absolute.channels.displacement is not None:
            refuse_slips(model, measurements)
        single, told = without_copies(measurements)
        if told:
            warnings.warn(told, ToolkitWarning, stacklevel=3)
        return explain_positions(model, single, holdout=holdout, options=options, progress=progress)
    return explain_displacements(
        model, measurements, holdout=holdout, options=options, progress=progress
    )


def explain_displacements(
    model: Model,
    measurements: Measurements,
    *,
    holdout: Measurements | None = None,
    options: Options | None = None,
    progress: Progress | None = None,
) -> Explanation:
    """See `explain`."""
    options = options or Options()
    tell = progress or _silent
    _refuse_unexplainable(model, measurements)
    sound, units = _sound(model, as_seen(model.robot, measurements))
    used, rows = sound.masked(), np.flatnonzero(sound.use)
    tell("searching the catalogue", 0.05)
    first, under = _selections(model, used, options)
    found, noise = best_selection(used, first, under)
    if noise.force:
        known = with_by_force(found.final.model, used)
        if not moved_alike(known, found.final.problem.measurements):
            used = known
            first, under = _selections(model, used, options)
            found, noise = best_selection(used, first, under)
    base = held_against(noise, found.base)
    tell("confirming on other poses", 0.3)
    found, named, account = judged_names(found, base, under, seed=options.seed)
    found, named = without_rigid_gears(found, named)
    rivals, judged = soft_rivals(found), found
    found, named = with_soft_parts(found, named, rivals, seed=options.seed)
    rivals = rivals if found is judged else soft_rivals(found)
    found = replace(found, final=with_settled_sizes(found.final))
    base = of_readings(found.base.problem.measurements, base)
    left = adequacy_of(found, noise)
    tell("the gap step by step", 0.7)
    goes_with = None if account is None else account.suspect
    remainder = remainder_of(_as_written(found.final, noise), left, goes_with)
    together = _together(found, named, account)
    findings = doubted_findings(
        named.findings, remainder.something_else, together, noise_known=noise.known
    )
    remainder = remainder.unless([part.probability for part in together])
    laws = {effect.id: effect for effect in found.final.model.effects}
    findings = tuple(
        replace(each, effect=laws.get(each.effect.id, each.effect)) for each in findings
    )
    effects = [finding.effect for finding in findings]
    beside = None if account is None else account.beside.final
    final = with_selection_uncertainty(found, findings, beside)
    verdict = _verdict(findings, left)
    steps = gap_steps(found, effects, holdout, seed=options.seed)
    if remainder.significant and account is None:
        remainder = _where_it_shows(remainder, held_against(noise, found.final))
    elif remainder.significant and account is not None:
        foretold = _worth_of_the_suspect(
            account, found, effects, holdout, steps[-1].heldout_rms, options.seed
        )
        shown = replace(account.goes_with(remainder.rms), foretold=foretold)
        remainder = replace(remainder, goes_with=shown)
    if remainder.significant:
        remainder = replace(remainder, shows=(*remainder.shows, *left.of_time))
    turned = axes_of_joint_angles(base)
    beyond = implausible(found) if remainder.significant else None
    softer = softer_instead(rivals) if beyond is None else {}
    near = (*named.doubted, *([] if beyond is None else [beyond.id]))
    suspects, guess = contenders(found, near if verdict == "outside" else (), seed=options.seed)
    written = beside_parts(
        _as_written(final, noise), model.catalogue, _no_other_parts(options, findings)
    )
    written = beside_form(written, effects)
    answer = Explanation(
        verdict=verdict,
        findings=findings,
        base=base,
        final=written,
        steps=steps,
        noise=noise,
        noise_reasons=(*decided(noise, used), *left.of_the_statement()),
        set_aside=tuple(rows[found.outliers].tolist()),
        readings=measurements,
        adequacy=left,
        remainder=remainder,
        unnamed=(
            *([] if turned is None else [turned]),
            *replace(named, findings=findings).reasons,
            *(part.sentence() for part in together if part.probability > WORTH_A_SENTENCE),
            *([] if beyond is None else [beyond.sentence]),
            *held_rigid(final),
            *mostly_parts(written),
            *_where_it_binds(found, options),
        ),
        notes=(
            *softer_than_customary(final, found.regression.soft),
            *softer.values(),
            *forms(final, effects),
        ),
        units=units,
        beyond=None if beyond is None else beyond.id,
        softer=tuple(softer),
        limits=options.limits,
        suspects=suspects,
        guess=guess,
        odds=doubted(
            one_more(found.regression, found.chosen),
            {each.id for each in named.fallen},
            remainder.something_else,
        ),
        catalogue=model.catalogue,
        borne_out=None if holdout is None or not effects else borne_out(base, final, holdout),
    )
    tell("what these readings cannot tell", 0.85)
    return completed(answer, found.regression, seed=options.seed, cell=options.cell)


def _no_other_parts(options: Options, findings: Sequence[Finding]) -> set[str]:
    """Effects that are known to be rigid, or whose moves count as another name's."""
    return {*options.exclude, *(name for each in findings for name in each.alternatives)}


def _where_it_shows(remainder: Remainder, final: Fit) -> Remainder:
    """The remainder with what is seen of its place in the gap of the final fit."""
    found = localise(final)
    closest = None if found.strongest is None else found.strongest.name
    return replace(remainder, shows=where_sentences(found)[1 : 1 + TOLD], closest=closest)


def _worth_of_the_suspect(
    account: Account,
    found: Selection,
    effects: Sequence[Effect],
    holdout: Measurements | None,
    without: float,
    seed: int,
) -> Foretold | None:
    """How much nearer other poses are foretold with it.

    A hold-out file, measured at another time, says nothing of what changed on the way.
    """
    beside = account.beside
    if holdout is not None and changed_at(account.suspect) is None:
        return foretold_on_file(found, beside, account.suspect, effects, holdout, without)
    if holdout is not None:
        without = on_poses_left_out(found, [len(effects)], seed)[0]
    return foretold_beside(beside, len(effects), without, seed=seed)


def _together(found: Selection, named: Named, account: Account | None) -> tuple[Imitated, ...]:
    """Names of one gear that may be one cause; beside model-form error that was asked before."""
    if account is not None or found.final.problem.noise.form:
        return ()
    return imitated_together(found.final, [finding.effect for finding in named.findings])


def _where_it_binds(found: Selection, options: Options) -> tuple[str, ...]:
    """That more effects might have been found, had more been looked for."""
    if len(found.chosen) < options.max_effects or not options.max_effects:
        return ()
    return (
        f"All {options.max_effects} effects that may be named at most were found; there may be "
        "more: ask for more with --max-effects.",
    )


def _verdict(findings: Sequence[Finding], left: Adequacy) -> Outcome:
    """What is confirmed is named, whatever is left beside it."""
    if not findings:
        return "outside" if left.lacking else "none"
    return "named" if all(finding.settled for finding in findings) else "ambiguous"


def _refuse_unexplainable(model: Model, measurements: Measurements) -> None:
    refuse_unusable(model, measurements)
    if len(measurements.masked().poses) < 2:
        raise InputError(
            "readings of one pose alone cannot be explained: no other pose can confirm a name",
            where=measurements.place,
            remedy="Measure at two poses or more; springs alone come from 'sk120stiff identify'.",
        )


def _selections(model: Model, measurements: Measurements, options: Options) -> tuple[Fit, Try]:
    """The base model fitted, and selections by the noise and by what joins the base model."""
    base_model = with_assumed(model, measurements, options.assume)
    candidates = candidates_for(base_model, measurements, options)
    plain = tuple(effect for effect in candidates if not effect.random_effects)
    undescribed = len({noise.zero for noise in noise_candidates(measurements)}) > 1

    first = fit(base_model, measurements, noise=noise_candidates(measurements)[0])
    if measurements.by_force is None:
        with suppress(Refusal):  # then no error of a force is asked for
            measurements = with_by_force(first.model, measurements)
    soft, at_first = brought(first, candidates, alpha=options.alpha, prior=options.prior)
    known: dict[tuple[Effect | None, bool], Linearised | None] = {(None, True): at_first}

    def under(chosen: NoiseModel, beside: Effect | None = None) -> Selection:
        # Constants of single poses are what a shared zero brings; it need not have been separate.
        # Beside model-form error they are part of it.
        constants = not (chosen.form or (undescribed and chosen.zero == "separate"))
        found = select(
            base_model if beside is None else base_model + beside,
            measurements,
            chosen,
            candidates if constants else plain,
            max_effects=options.max_effects,
            alpha=options.alpha,
            prior=options.prior,
            soft=soft,
            near=known.get((beside, constants)),
        )
        if found.at_base is not None:
            known[beside, constants] = found.at_base
        return found

    return first, under


def _sound(model: Model, measurements: Measurements) -> tuple[Measurements, str | None]:
    """The readings with copied rows masked, once nothing in them looks like a slip of the pen.

    And why their units are in doubt, if they are.
    """
    sound, wild = without_wild(model.robot, measurements)
    scale = refuse_slips(model, sound).scale
    single, copied = without_copies(sound)
    for told in (wild, copied):
        if told:
            warnings.warn(told, ToolkitWarning, stacklevel=4)
    return single, None if scale is None else scale.sentence


def _silent(phrase: str, share: float) -> None:
    """No one wants to know."""
    del phrase, share


def _as_written(final: Fit, noise: NoiseModel) -> Fit:
    """The fit that goes into files: by the noise as stated, beside model-form error if there is."""
    return final if final.problem.noise.form else held_against(noise, final)
