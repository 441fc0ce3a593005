"""The one door: level, seed and number make a case."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .case import Case
from .equilibrium import NoEquilibrium
from .levels import Builder, NotThisTime, Rng, clean, pair, several, single
from .levels_hard import alias, clean_messy, outside, wild
from .levels_positions import positions
from .levels_real import beside, lifelike, otherwise, still
from .position_case import PositionCase

AnyCase = Case | PositionCase

BUILDERS: dict[str, Builder | Callable[[str, tuple[int, ...], Rng], PositionCase]] = {
    "L0": clean,
    "L1": single,
    "L2": single,
    "L3": single,
    "L4": pair,
    "L5": alias,
    "L6": several,
    "L7": outside,
    "L8": clean_messy,
    "L9": wild,
    "L10": lifelike,
    "L12": beside,
    "L1.plans": otherwise,
    "L2.plans": otherwise,
    "L0.plans": still,
    "L11": positions,
    "L11.rigid": positions,
}


def build(level: str, seed: int, number: int) -> AnyCase:
    """A case that depends on nothing but its arguments.

    Draws that cannot show what the level asks for are thrown away; the number of throws is part
    of the seed, so a case stays the same.
    """
    index = list(BUILDERS).index(level)  # new levels come last: seeds of old ones stay
    for attempt in range(200):
        key = (seed, index, number, attempt)
        rng = np.random.default_rng(key)
        try:
            case = BUILDERS[level](level, key, rng)
            case.check()
            return case
        except (NotThisTime, NoEquilibrium, np.linalg.LinAlgError):
            continue
    raise RuntimeError(f"no {level} case for seed {seed}, number {number}")


def rebuild(level: str, key: list[int]) -> AnyCase:
    """The case whose truth file holds this level and seed."""
    return BUILDERS[level](level, tuple(key), np.random.default_rng(tuple(key)))
