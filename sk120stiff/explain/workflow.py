"""Fit becomes an `Explanation`: search, tell apart, confirm, add, judge what is left."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from sk120stiff.effects import BY_NAME, Effect, all_effects, situation_of
from sk120stiff.errors import InputError
from sk120stiff.explain.adequacy import Adequacy, adequacy
from sk120stiff.explain.aliases import aliases_by_design, exact_aliases
from sk120stiff.explain.confirm import confirm, pose_folds
from sk120stiff.explain.consequences import completed
from sk120stiff.explain.explanation import Evidence, Explanation, Finding, Step, Verdict
from sk120stiff.explain.outliers import outlying_rows
from sk120stiff.explain.regression import Regression, regression_at
from sk120stiff.explain.search import Scored, beam_search, gains, score_set
from sk120stiff.identify import Fit, Problem, fit, solve
from sk120stiff.identify.saturated import choose_noise
from sk120stiff.measurements import Measurements, NoiseModel
from sk120stiff.model import Model

MARGIN = 6.0  # difference of scores below which two names cannot be told apart
LEFT_OVER = 0.2  # share of the named signature that may remain unexplained before a name is doubted
ROUNDS = 4  # of linearising, searching and refitting

Progress = Callable[[str, float], None]


@dataclass(frozen=True)
class Options:
    """How the user steers the search.

    Attributes
    ----------
    only, exclude
        Effects (``name`` or ``name:where``) to which the search is limited, or which it leaves out.
    assume
        Effects that are in the model from the start.
    max_effects
        Largest number of named effects.
    seed
        Of folds and resampling.
    """

    only: tuple[str, ...] = ()
    exclude: tuple[str, ...] = ()
    assume: tuple[str, ...] = ()
    max_effects: int = 4
    seed: int = 0


def explain(
    model: Model,
    measurements: Measurements,
    *,
    holdout: Measurements | None = None,
    options: Options | None = None,
    progress: Progress | None = None,
) -> Explanation:
    """Find where model and readings disagree, name what is missing, add it, judge the rest.

    Parameters
    ----------
    model
        The base model; its effects are part of every model considered.
    measurements
        Readings to be explained.
    holdout
        Readings of other poses, kept out of everything; the gap on them is reported.
    options
        How the search is steered.
    progress
        Called with a phrase and a share of the work done.

    Raises
    ------
    InputError
        No displacements, too few readings, or an effect that does not exist.
    Refusal
        The base model itself cannot be fitted.
    """
    wish = options or Options()
    tell = progress or (lambda phrase, share: None)
    tell("noise and base model", 0.0)
    used = measurements.masked()
    base_model = _with_assumed(model, used, wish.assume)
    candidates = _candidates(base_model, used, wish)
    base_ids = [effect.id for effect in base_model.effects]
    noise, reasons = choose_noise(used, situation_of(base_model.robot, used))
    base = fit(base_model, used, noise=noise)
    first = regression_at(base, candidates, base_ids)
    aside = outlying_rows(first, base.problem.whitener)
    if len(aside):
        keep = np.ones(used.n_readings, dtype=bool)
        keep[aside] = False
        used = used.select(keep)
        base = fit(base_model, used, noise=noise)
        first = regression_at(base, candidates, base_ids)
    tell("searching the catalogue", 0.2)
    final, regression, ranked = _settle(base, first, candidates, base_ids, wish.max_effects)
    tell("confirming on other poses", 0.5)
    findings, doubted = _findings(final, regression, ranked, wish)
    if doubted:
        kept = [finding.effect for finding in findings]
        final = _refit(base, kept)
        regression = regression_at(final, candidates, base_ids)
    chosen = _positions(regression, [finding.effect.id for finding in findings])
    columns = score_set(regression, regression.sums(), chosen).solved.columns
    left = adequacy(final, regression, columns)
    verdict = _verdict(findings, left)
    tell("the gap step by step", 0.7)
    steps = _steps(base, [finding.effect for finding in findings], holdout, noise, wish.seed)
    answer = Explanation(
        verdict=verdict,
        findings=tuple(findings) if verdict != "outside" else (),
        base=base,
        final=final if verdict != "outside" else base,
        steps=tuple(steps) if verdict != "outside" else tuple(steps[:1]),
        noise=noise,
        noise_reasons=tuple(reasons),
        set_aside=tuple(int(row) for row in aside),
        adequacy=left,
        suspects=_suspects(regression, ranked, doubted) if verdict == "outside" else (),
    )
    tell("what these readings cannot tell", 0.85)
    return completed(answer, regression, candidates, seed=wish.seed)


def _with_assumed(model: Model, used: Measurements, assumed: Sequence[str]) -> Model:
    for wanted in assumed:
        found = [e for e in all_effects(model.robot, poses=used.poses) if _matches(e, wanted)]
        if not found:
            raise _unknown(wanted, model)
        for effect in found:
            if effect.id not in {present.id for present in model.effects}:
                model = model + effect
    return model


def _candidates(model: Model, used: Measurements, wish: Options) -> tuple[Effect, ...]:
    """Effects of the catalogue that the readings could show and the user does not exclude."""
    situation = situation_of(model.robot, used)
    present = {effect.id for effect in model.effects}
    everything = all_effects(model.robot, poses=used.poses, timed=used.time is not None)
    for wanted in (*wish.only, *wish.exclude):
        if not any(_matches(effect, wanted) for effect in everything):
            raise _unknown(wanted, model)
    return tuple(
        effect
        for effect in everything
        if effect.id not in present
        and effect.applies_to(situation)
        and not any(_matches(effect, wanted) for wanted in wish.exclude)
        and (not wish.only or any(_matches(effect, wanted) for wanted in wish.only))
    )


def _matches(effect: Effect, wanted: str) -> bool:
    return wanted in (effect.name, effect.id)


def _unknown(wanted: str, model: Model) -> InputError:
    name, _, where = wanted.partition(":")
    if name in BY_NAME:
        places = BY_NAME[name].places(model.robot)
        return InputError(
            f"the effect {name!r} cannot act at {where!r} on {model.robot.name}",
            remedy=f"It acts at: {', '.join(places) or 'no place of this robot'}.",
        )
    return InputError(
        f"there is no effect {wanted!r}", remedy=f"Effects are: {', '.join(BY_NAME)}."
    )


def _refit(base: Fit, effects: Sequence[Effect]) -> Fit:
    """The base model with effects added, fitted at exact equilibrium to the same readings."""
    model = base.model
    for effect in effects:
        model = model + effect
    return solve(Problem(model, base.problem.measurements, base.problem.noise))


def _settle(
    base: Fit,
    first: Regression,
    candidates: Sequence[Effect],
    base_ids: Sequence[str],
    max_effects: int,
) -> tuple[Fit, Regression, list[Scored]]:
    """Linearise, search, refit exactly, until the search confirms the model it is made at."""
    found, regression = base, first
    ranked = beam_search(regression, max_effects=max_effects)
    for _ in range(ROUNDS):
        chosen = [regression.candidates[e] for e in ranked[0].effects]
        if {e.id for e in chosen} == {e.id for e in found.model.effects} - set(base_ids):
            break
        found = _refit(base, chosen)
        regression = regression_at(found, candidates, base_ids)
        ranked = beam_search(regression, max_effects=max_effects)
    else:
        chosen = [regression.candidates[e] for e in ranked[0].effects]
        found = _refit(base, chosen)
        regression = regression_at(found, candidates, base_ids)
        ranked = beam_search(regression, max_effects=max_effects)
    return found, regression, ranked


def _positions(regression: Regression, ids: Sequence[str]) -> tuple[int, ...]:
    where = {effect.id: k for k, effect in enumerate(regression.candidates)}
    return tuple(where[wanted] for wanted in ids)


def _findings(
    final: Fit, regression: Regression, ranked: Sequence[Scored], wish: Options
) -> tuple[list[Finding], list[str]]:
    """Findings in the order of their weight, and the effects that did not survive confirmation."""
    sums = regression.sums()
    model = ranked[0].effects
    findings: list[Finding] = []
    doubted: list[str] = []
    for effect in _by_weight(regression, model):
        rest = tuple(e for e in model if e != effect)
        with_it = score_set(regression, sums, model)
        without = score_set(regression, sums, rest)
        swaps = _swaps(regression, rest, effect)
        chosen = regression.candidates[effect]
        contenders = [
            regression.candidates[e]
            for e, other in swaps
            if other.solved.rss - with_it.solved.rss < 2.0 * MARGIN
        ]
        exact = exact_aliases(
            final.model,
            chosen,
            contenders,
            point=final.problem.situation.point,
            tied=with_it.variants[with_it.effects.index(effect)] > 0,
        ) + aliases_by_design(chosen, regression.candidates, final.problem.situation)
        same = [
            e
            for e, other in swaps
            if other.score - with_it.score < MARGIN or regression.candidates[e].id in exact
        ]
        others = [(e, other.score) for e, other in swaps if e not in same]
        checked = confirm(regression, model, effect, same, seed=wish.seed)
        if not checked.holds:
            doubted.append(chosen.id)
            continue
        runner_up = min(others, key=lambda pair: pair[1], default=None)
        findings.append(
            Finding(
                effect=chosen,
                alternatives=tuple(
                    dict.fromkeys([*(regression.candidates[e].id for e in same), *exact])
                ),
                exact=exact,
                evidence=Evidence(
                    score_gain=without.score - with_it.score,
                    misfit_gain=without.solved.rss - with_it.solved.rss,
                    runner_up=None if runner_up is None else regression.candidates[runner_up[0]].id,
                    runner_up_gap=np.inf if runner_up is None else runner_up[1] - with_it.score,
                    confirmation=checked,
                ),
            )
        )
    return findings, doubted


def _by_weight(regression: Regression, model: tuple[int, ...]) -> list[int]:
    """Order in which a greedy observer would add the effects of a model."""
    sums = regression.sums()
    order: list[int] = []
    while len(order) < len(model):
        left = [e for e in model if e not in order]
        order.append(min(left, key=lambda e: score_set(regression, sums, (*order, e)).solved.rss))
    return order


def _swaps(regression: Regression, rest: tuple[int, ...], effect: int) -> list[tuple[int, Scored]]:
    """The other candidates that promise most in the place of one effect, with their models."""
    sums = regression.sums()
    promise = gains(regression, sums, score_set(regression, sums, rest).solved)
    order = [int(e) for e in np.argsort(-promise) if int(e) not in (*rest, effect)][:24]
    found = [(e, score_set(regression, sums, (*rest, e))) for e in order]
    return [(e, model) for e, model in found if model.plausible]


def _verdict(findings: Sequence[Finding], left: Adequacy) -> Verdict:
    if left.lacking and left.excess > LEFT_OVER * left.explained:
        return "outside"
    if not findings:
        return "none"
    return "named" if all(finding.settled for finding in findings) else "ambiguous"


def _suspects(
    regression: Regression, ranked: Sequence[Scored], doubted: Sequence[str]
) -> tuple[str, ...]:
    nearest = [regression.candidates[e].id for e in ranked[0].effects]
    return tuple(dict.fromkeys([*nearest, *doubted]))


def _steps(
    base: Fit,
    effects: Sequence[Effect],
    holdout: Measurements | None,
    noise: NoiseModel,
    seed: int,
) -> list[Step]:
    steps = []
    for count in range(len(effects) + 1):
        added = list(effects[:count])
        found = base if not added else _refit(base, added)
        label = "joint_springs" if not added else f"+ {added[-1].id}"
        steps.append(Step(label, found.rms, _held_out_rms(found, holdout, noise, seed)))
    return steps


def _held_out_rms(
    found: Fit, holdout: Measurements | None, noise: NoiseModel, seed: int
) -> float:
    """Gap on the hold-out file, or on poses left out in turn, per axis [m]."""
    if holdout is not None:
        other = Problem(found.model, holdout.masked(), noise)
        gap = other.measured - found.model.predict(other.situation)
        return float(np.sqrt(np.mean(gap**2)))
    measurements = found.problem.measurements
    pose = measurements.pose_index
    fold = pose_folds(len(measurements.poses), np.random.default_rng(seed))[pose]
    squares = 0.0
    for k in np.unique(fold):
        train = measurements.select(fold != k)
        part = solve(Problem(found.model, train, noise))
        test = Problem(part.model, measurements.select(fold == k), noise)
        squares += float(((test.measured - part.model.predict(test.situation)) ** 2).sum())
    return float(np.sqrt(squares / (3 * measurements.n_readings)))


