"""How the readings of a plan are chosen, for which effects, and what is said of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from sk120stiff.cli.tables import table
from sk120stiff.effects import Effect, effect, load_cases_of
from sk120stiff.errors import InputError
from sk120stiff.identify import why_unseen
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model
from sk120stiff.plan import (
    Pool,
    d_optimal,
    promised,
    random_choice,
    rivalry,
    to_be_taken,
    well_spread,
)
from sk120stiff.plan.design import refuse_count

DRAWS = 50  # random and well-spread choices that a plan is held against

Chosen = tuple[Sequence[int], dict[str, object], list[object]]


def precise(
    model: Model,
    pool: Pool,
    known: Measurements | None,
    asked: Sequence[str] | None,
    count: tuple[int, int],
    sigma: float,
    seed: int,
) -> Chosen:
    """Readings that make parameters well known."""
    names: list[str] = []
    for text in asked or ():
        model, found = named_parameters(model, text)
        names += found
    wanted, untold = _of_a_plan(model, pool, names)
    before = None if known is None else Pool(load_cases_of(model.robot, known.masked()))
    design = d_optimal(
        model, pool, count=count[0], loads=count[1], sigma=sigma, parameters=wanted, known=before,
    )  # fmt: skip
    random, spread = _held_against(design.gain_over, pool, len(design.rows), seed)
    zero = "unknown" if known is None else known.zero
    plan = to_be_taken(model.robot, pool, design.rows, zero=zero)
    every = dict(
        zip((model.names[k] for k in model.free), promised(model, plan, sigma, known), strict=True)
    )
    expected: list[dict[str, object]] = []
    rows: list[tuple[object, ...]] = []
    chosen = pool.load_cases.rows(np.array(design.rows, dtype=np.intp))
    blind: list[object] = []
    for name in (*design.parameters, *untold):
        std = every[name]
        p = model.parameter(name)
        public, unit = p.spec.public_std(p.internal, float(std)), p.spec.unit
        why = why_unseen(chosen, p)
        if why is None and not np.isfinite(std):
            why = untold.get(name, "these readings tell less of it than is plausible of any arm")
        expected.append(
            {
                "name": name,
                "value": p.value,
                "std": None if why else public,
                "unit": unit,
                "internal_std": None if why else float(std),
                "internal_unit": p.spec.internal_unit,
                "reason": why,
            }
        )
        if why:
            blind.append(f"{name} cannot be seen: {why}.")
            rows.append((name, p.value, "cannot be seen", unit))
            continue
        shown = (public, unit) if np.isfinite(public) else (float(std), p.spec.internal_unit)
        rows.append((name, p.value, *shown))
    document: dict[str, object] = {
        "criterion": "D-optimal",
        "for": [*design.parameters, *untold],
        "gain": random,
        "gain_over_spread": spread,
        "expected": expected,
    }
    said: list[object] = [
        table("To expect", ["parameter", "value", "std. error", "unit"], rows),
        f"Standard errors {random:.2f} times smaller than with random poses, {spread:.2f} times "
        "smaller than with well-spread ones.",
        *blind,
    ]
    return design.rows, document, said


def _of_a_plan(model: Model, pool: Pool, asked: list[str]) -> tuple[list[str], dict[str, str]]:
    """Parameters that a plan can be made for, all free ones by default, and why others cannot.

    A plan has no clock: what goes by the order of the readings is known once they are taken.

    Raises:
        InputError: There is nothing to plan for.
    """
    names = list(dict.fromkeys(asked or (model.names[k] for k in model.free)))
    untold = {}
    for name in names:
        if why := _why_untold(model.parameter(name).effect, pool):
            untold[name] = why
    if names and len(untold) == len(names):
        raise InputError(
            f"nothing to plan for: {names[0]}: {untold[names[0]]}",
            where="--for" if asked else model.robot.name,
            remedy="Plan for other parameters; write that down when you measure.",
        )
    return [name for name in names if name not in untold], untold


def _why_untold(effect: Effect, pool: Pool) -> str | None:
    """Why no plan shows an effect, in words; None: one may."""
    if effect.applies_to(pool.load_cases):
        return None
    return f"it shows only in readings with {effect.needs}, which no plan holds"


def telling(
    model: Model,
    pool: Pool,
    before: Pool | None,
    between: str,
    count: tuple[int, int],
    sigma: float,
    seed: int,
) -> Chosen:
    """Readings that tell two effects apart."""
    first, second = two_effects(model, between)
    for each in (first, second):
        if why := _why_untold(each, pool):
            raise InputError(
                f"no plan tells {each.id} from anything: {why}",
                where="--between",
                remedy="Ask 'explain', once the readings with it are there.",
            )
    rivals = rivalry(model, first, second, pool, sigma=sigma, known=before)
    refuse_count(pool, *count)
    choice = rivals.best(count[0], pool.pose, count[1])

    def gain_over(rows: Sequence[int]) -> float:
        return choice.after / max(rivals.evidence_of(rows), 1e-12)

    random, spread = _held_against(gain_over, pool, len(choice.rows), seed)
    document: dict[str, object] = {
        "criterion": "T-optimal",
        "between": [first.id, second.id],
        "gain": random,
        "gain_over_spread": spread,
        "evidence": choice.after,
        "evidence_before": choice.before,
    }
    verdict = (
        "enough to tell them apart" if choice.after > 3.3 else "not enough: plan more readings"
    )
    said: list[object] = [
        f"Evidence between {first.id} and {second.id}: {choice.after:.2f} standard errors "
        f"({verdict}), {choice.before:.2f} before.",
        f"{random:.2f} times that of random poses, {spread:.2f} times that of well-spread ones.",
    ]
    return choice.rows, document, said


def _held_against(
    gain_over: Callable[[Sequence[int]], float], pool: Pool, count: int, seed: int
) -> tuple[float, float]:
    """Median gain over random and over well-spread choices."""
    rng = np.random.default_rng(seed + 1)
    random = [gain_over(random_choice(pool, count, rng)) for _ in range(DRAWS)]
    spread = [gain_over(well_spread(pool, count, rng)) for _ in range(DRAWS)]
    return float(np.median(random)), float(np.median(spread))


def named_parameters(model: Model, text: str) -> tuple[Model, list[str]]:
    """The model with the parameter's effect in it, and the parameters that are meant."""
    head, dot, _ = text.rpartition(".")
    if dot and text in model.names:
        return model, [text]
    present = [p.name for p in model.parameters if text in (p.effect.id, p.effect.name)]
    if present:
        return model, present
    name, _, where = (head if dot else text).partition(":")
    added = effect(model.robot, name, where or None)
    larger = model if added.id in {e.id for e in model.effects} else model + added
    if not dot:
        return larger, [p.name for p in larger.parameters if p.effect.id == added.id]
    return larger, [larger.parameter(text).name]


def two_effects(model: Model, text: str) -> tuple[Effect, Effect]:
    """Two effects in one text; the name of a place may hold a comma itself."""
    words = text.split(",")
    failure: InputError | None = None
    for cut in range(1, len(words)):
        try:
            first, second = (
                _effect(model, ",".join(part).strip()) for part in (words[:cut], words[cut:])
            )
        except InputError as error:
            failure = failure or error
            continue
        if first.id == second.id:
            raise InputError(f"{first.id!r} stands there twice", where="--between")
        return first, second
    if failure is not None:
        raise failure
    raise InputError(
        f"{text!r} does not name two effects",
        where="--between",
        remedy="Write two with a comma between them: 'base_rocking,joint_tilt:joint_1_s'.",
    )


def _effect(model: Model, text: str) -> Effect:
    for present in model.effects:
        if text in (present.id, present.name):
            return present
    name, _, where = text.partition(":")
    return effect(model.robot, name, where or None)
