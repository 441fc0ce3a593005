"""Which readings of a pool are chosen, and how much better than choices without a design."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import Effect
from sk120stiff.errors import InputError
from sk120stiff.model import Model
from sk120stiff.plan.design import Design, d_optimal, random_choice, refuse_count, well_spread
from sk120stiff.plan.discriminate import Rivalry, rivalry
from sk120stiff.plan.pool import Pool, same_pose

DRAWS = 50  # random and well-spread choices that a plan is held against


@dataclass(frozen=True, eq=False)
class Chosen:
    """Readings chosen from a pool.

    Attributes:
        rows: (K,) chosen candidates.
        names: The parameters to be known, or the two effects to be told apart.
        gain_over: How many times better than other rows of the pool they are.
        untold: Parameter → why no plan shows it.
        evidence: √λ between the two effects before and after, in units of the noise; None where
            parameters are to be known.
        design: Where parameters are to be known: how well they will be.
        loads: Of each pose.
    """

    pool: Pool
    rows: Sequence[int]
    names: tuple[str, ...]
    gain_over: Callable[[Sequence[int]], float]
    untold: Mapping[str, str] = field(default_factory=dict)
    evidence: tuple[float, float] | None = None
    design: Design | None = None
    loads: int = 1

    def without(self, lost: Sequence[Array]) -> Chosen:
        """The same without some poses (n,)."""
        a = self.pool.load_cases.a
        rows = [k for k in self.rows if not any(same_pose(a[k], other) for other in lost)]
        design = None if self.design is None else self.design.of_rows(rows)
        return replace(self, rows=rows, design=design)

    def gains(self, seed: int) -> tuple[float, float]:
        """Median gain over random and over well-spread choices of the pool."""
        rng, loads = np.random.default_rng(seed + 1), self.loads
        asked = self.pool, len(self.rows) // loads, rng, loads
        random = [self.gain_over(random_choice(*asked)) for _ in range(DRAWS)]
        spread = [self.gain_over(well_spread(*asked)) for _ in range(DRAWS)]
        return float(np.median(random)), float(np.median(spread))


def precise(
    model: Model,
    pool: Pool,
    size: tuple[int, int],
    *,
    sigma: float,
    asked: Sequence[str],
    known: Pool | None,
) -> Chosen:
    """Readings that make parameters well known; `size`: number of poses, and of loads at each.

    A plan has no clock: what goes by the order of the readings is known once they are taken.

    Raises:
        InputError: There is nothing to plan for, or there are too few candidates.
    """
    names = list(dict.fromkeys(asked or (model.names[k] for k in model.free)))
    why = {name: _why_untold(model.parameter(name).effect, pool) for name in names}
    untold = {name: told for name, told in why.items() if told}
    if names and len(untold) == len(names):
        raise InputError(
            f"nothing to plan for: {names[0]}: {untold[names[0]]}",
            where="--for" if asked else model.robot.name,
            remedy="Plan for other parameters; write that down when you measure.",
        )
    design = d_optimal(
        model, pool, count=size[0], loads=size[1], sigma=sigma, known=known,
        parameters=[name for name in names if name not in untold],
    )  # fmt: skip
    names = [*design.parameters, *untold]
    return Chosen(
        pool, design.rows, tuple(names), design.gain_over, untold, design=design, loads=size[1]
    )


def telling(
    model: Model,
    pool: Pool,
    size: tuple[int, int],
    *,
    sigma: float,
    between: tuple[Effect, Effect],
    known: Pool | None,
) -> Chosen:
    """Readings that tell two effects apart.

    Raises:
        InputError: No plan shows one of them, or there are too few candidates.
    """
    for each in between:
        if why := _why_untold(each, pool):
            raise InputError(
                f"no plan tells {each.id} from anything: {why}",
                where="--between",
                remedy="Ask 'explain', once the readings with it are there.",
            )
    rivals = rivalry(model, *between, pool, sigma=sigma, known=known)
    refuse_count(pool.pose, *size)
    return told_apart(rivals, pool, size, between)


def told_apart(
    rivals: Rivalry, pool: Pool, size: tuple[int, int], between: tuple[Effect, Effect]
) -> Chosen:
    """The candidates of a pool that tell two effects apart best; `size` as of `precise`."""
    choice = rivals.best(size[0], pool.pose, size[1])

    def gain_over(rows: Sequence[int]) -> float:
        return choice.after / max(rivals.evidence_of(rows), 1e-12)

    names = (between[0].id, between[1].id)
    evidence = choice.before, choice.after
    return Chosen(pool, choice.rows, names, gain_over, evidence=evidence, loads=size[1])


def _why_untold(effect: Effect, pool: Pool) -> str | None:
    """Why no plan shows an effect, in words; None: one may."""
    if effect.applies_to(pool.load_cases):
        return None
    return f"it shows only in readings with {effect.needs}, which no plan holds"
