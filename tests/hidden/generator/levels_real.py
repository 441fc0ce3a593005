"""L10 laws right in kind and wrong in detail, L12 a known cause beside a foreign one, and plain
causes under other plans of measuring."""

from __future__ import annotations

import numpy as np

from tests.hidden.families import HYSTERETIC

from .case import Case
from .draw import Choice, choices, foreign, unit_causes
from .draw_real import real
from .levels import PAIR, NotThisTime, Rng, Setting, hide, one, pick, shows, together
from .plans import measured
from .rotations import Array
from .signature import Blocks, View, beyond, blocks, orthonormal, rivals, signature, tuned, view
from .world import Cause


def lifelike(level: str, seed: tuple[int, ...], rng: Rng) -> Case:
    """L10: one to three causes, weak to very strong, whose laws are nearly the catalogue's."""
    at = measured(level, seed, rng, usual=0.3)
    count = int(rng.integers(1, 4))
    causes, entries = together(
        at, rng, count, low=10.0, high=150.0, least=8.0, apart=6.0, pool=lifelike_pool(at)
    )
    laws = [type(cause).__name__ for cause in causes]
    return at.case(
        causes, hidden=entries, note=f"{at.plan} {'+'.join(laws)}",
        truth_extra={"count": count, "plan": at.plan, "laws": laws},
    )  # fmt: skip


def lifelike_pool(at: Setting) -> list[Choice]:
    """Lifelike causes that this experiment can show."""
    # a zero of its own for every row takes the load off in between: nothing is left of a loop
    return [c for c in real(at.arm) if c.name not in HYSTERETIC or at.noise.shared_zero]


def beside(level: str, seed: tuple[int, ...], rng: Rng) -> Case:
    """L12: a cause of the catalogue and a foreign one, each plain beyond the other."""
    at = measured(level, seed, rng, usual=0.5)
    seen = view(at.world, at.train, at.noise)
    pool = [c for c in choices(at.arm) if shows(c, at) and c.name != "zero_offset"]
    known = tuned(seen, pick(pool, rng).make(rng), float(np.exp(rng.uniform(*np.log((26, 80))))))
    strange = tuned(
        seen, pick([c for c in foreign(at.arm) if shows(c, at)], rng).make(rng),
        float(np.exp(rng.uniform(*np.log((20, 60))))), widest=10.0,
    )  # fmt: skip
    if known is None or strange is None:
        raise NotThisTime("sizes")
    table = blocks(seen, unit_causes(at.arm))
    own = table.columns[table.names.index((known.name, known.where))]
    u, v = signature(seen, known), signature(seen, strange)
    if beyond(u, v[:, None]) < 12.0 or beyond(v, own) < 12.0:
        raise NotThisTime("one hides the other")
    entry = hide(at, known, seen, table)
    near = rivals(u, (known.name, known.where), table, v[:, None])[0]
    if entry.rivals[0].angle < PAIR or near.separation < 6.0:
        raise NotThisTime(f"{known.name} looks like {near.name}")
    if rivals(v, (known.name, known.where), table, own)[0].separation < 8.0:
        raise NotThisTime(f"{strange.name} has a name")
    left = remainder(seen, table, known, strange)
    return at.case(
        [known, strange], hidden=[entry], note=f"{at.plan} {strange.name}:{strange.where}",
        truth_extra={
            "plan": at.plan, "foreign": f"{strange.name}:{strange.where}",
            "remainder_um": round(1e6 * float(np.sqrt(np.mean(left**2))), 3),
        },
    )  # fmt: skip


def remainder(seen: View, table: Blocks, known: Cause, strange: Cause) -> Array:
    """What the best model with base springs and the known cause leaves of the readings (3N,) [m]:
    least squares by the true noise, all parameters of the known cause free."""
    world = seen.world
    both = world.with_causes(known, strange).displacement(seen.rows)
    change = seen.whiten(both - world.with_causes(known).displacement(seen.rows))
    own = table.columns[table.names.index((known.name, known.where))]
    basis = orthonormal(np.concatenate([seen.base, own], axis=1))
    out: Array = np.linalg.solve(seen.white, change - basis @ (basis.T @ change))
    return out


STRENGTHS = {"L1.plans": (26.0, 80.0), "L2.plans": (8.0, 25.0)}


def otherwise(level: str, seed: tuple[int, ...], rng: Rng) -> Case:
    """L1 and L2 under other plans of measuring, with noise stated wrongly or not at all."""
    at = measured(level, seed, rng)
    return one(at, rng, *STRENGTHS[level], apart=4.0)


def still(level: str, seed: tuple[int, ...], rng: Rng) -> Case:
    """L0 under other plans of measuring, with noise stated wrongly or not at all."""
    at = measured(level, seed, rng)
    return at.case([], expected="none", note=at.plan)
