"""Cases of all levels of EVIDENCE: what is hidden, how strongly, and which noise lies on it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tests.hidden.families import GEAR, family

from .arm import Arm
from .case import Case, Hidden
from .design import plan
from .draw import Choice, choices, unit_causes
from .noise import Noise
from .robots import random_arm, six_axis, telescope, urdf_text, varied
from .rows import Rows
from .signature import Blocks, Rival, View, beyond, blocks, rivals, signature, tuned, view
from .sk120 import sk120
from .world import Cause, World

Rng = np.random.Generator
# what a cause needs to show itself is listed with the plainer schedules
SHOWN_BY = {"single": "scattered", "three_axes": "scattered", "ladder": "up_down",
            "reloads": "repeated"}  # fmt: skip
PAIR = 12.0  # degrees between two causes below which they are a near pair


class NotThisTime(RuntimeError):
    """The draw cannot show what the level asks for; draw again."""


@dataclass(frozen=True)
class Setting:
    """An arm, its base springs, the experiment and its noise, before anything is hidden."""

    level: str
    arm: Arm
    urdf: str | None
    world: World
    train: Rows
    holdout: Rows
    sealed: Rows
    noise: Noise
    positions: bool
    force_frame: str
    seed: tuple[int, ...]
    schedule: str
    plan: str = "usual"

    def case(self, causes: Sequence[Cause], **keywords: object) -> Case:
        return Case(
            level=self.level,
            arm=self.arm,
            world=self.world.with_causes(*causes),
            train=self.train,
            holdout=self.holdout,
            sealed=self.sealed,
            noise=self.noise,
            positions=self.positions,
            force_frame=self.force_frame,
            seed=self.seed,
            urdf=self.urdf,
            **keywords,  # type: ignore[arg-type]
        )


def setting(
    level: str,
    seed: tuple[int, ...],
    rng: Rng,
    *,
    arm: Arm | None = None,
    schedule: str | None = None,
    positions: bool | None = None,
    shared: bool | None = None,
    noise: Noise | None = None,
    urdf: str | None = None,
    sigma: tuple[float, float] = (4e-6, 20e-6),
    poses: int = 20,
    loads: int = 5,
    clusters: int = 0,
) -> Setting:
    """A random experiment; what is given stays fixed."""
    if arm is None:
        arm = [sk120, six_axis, telescope][rng.choice(3, p=[0.5, 0.25, 0.25])]()
    urdf = urdf_text(arm) if urdf is None else urdf
    if schedule is None:
        schedule = str(
            rng.choice(["ascending", "scattered", "up_down", "repeated"], p=[0.4, 0.35, 0.15, 0.1])
        )
    if positions is None:
        positions = bool(rng.random() < 0.3) if shared is not False else False
    if shared is None:
        shared = True if positions else bool(rng.random() < 0.6)
    if noise is None:
        size = float(np.exp(rng.uniform(*np.log(sigma))))
        declared = {} if rng.random() < 0.85 else {"noise": None}
        noise = Noise(size, shared_zero=shared, declared=declared)
    else:
        noise = replace(noise, shared_zero=shared)
    point = np.round(np.array([0.0, 0.0, 0.12]) + 0.07 * rng.normal(size=3), 4)
    force_point = None if rng.random() < 0.8 else np.round(point * 0.5, 4)
    keywords = {
        "shared_zero": shared,
        "moments": bool(rng.random() < 0.15),
        "point": point,
        "force_point": force_point,
        "schedule": schedule,
        "loads": loads,
    }
    half = (poses + 1) // 2
    train = plan(arm, rng, poses=poses, clusters=clusters, **keywords)  # type: ignore[arg-type]
    holdout = plan(arm, rng, poses=half, first_pose=101, **keywords)  # type: ignore[arg-type]
    sealed = plan(arm, rng, poses=10, first_pose=201, **keywords)  # type: ignore[arg-type]
    return Setting(
        level, arm, urdf, World(arm, varied(arm, rng)), train, holdout, sealed, noise, positions,
        str(rng.choice(["base", "tool"], p=[0.7, 0.3])), seed, schedule,
    )  # fmt: skip


def shows(choice: Choice, at: Setting) -> bool:
    """Whether the experiment can show the cause at all.

    A constant of every pose shows where poses have zeros of their own, and are read under several
    loads: read once, it is noise.
    """
    read_once = len(np.unique(at.train.pose)) == len(at.train.pose)
    ways = {
        SHOWN_BY.get(at.schedule, at.schedule),
        "positions" if at.positions else "",
        "" if at.noise.shared_zero or read_once else "separate",
    }
    return not choice.needs or bool(ways & set(choice.needs))


def pick(options: Sequence[Choice], rng: Rng) -> Choice:
    """A random cause: first its name, then its place, so that many places weigh no more."""
    name = str(rng.choice(sorted({choice.name for choice in options})))
    places = [choice for choice in options if choice.name == name]
    return places[int(rng.integers(len(places)))]


def nested_in(own: str, other: Rival) -> bool:
    """A rival with more freedom that contains the cause: the simpler name is the right one."""
    pairs = {("force_rotation", "force_crosstalk")}
    return (own, other.name) in pairs


def hide(at: Setting, cause: Cause, seen: View, table: Blocks) -> Hidden:
    """The cause with its visibility and its nearest rivals."""
    u = signature(seen, cause)
    found = rivals(u, (cause.name, cause.where), table)
    norm = float(np.linalg.norm(u))
    return Hidden(cause, norm, norm, [r for r in found if not nested_in(cause.name, r)])


def single(level: str, seed: tuple[int, ...], rng: Rng) -> Case:
    """L1 to L3: one cause of a given strength, told apart from all others at L1 and L2."""
    low, high = {"L1": (26.0, 80.0), "L2": (8.0, 25.0), "L3": (4.0, 8.0)}[level]
    return one(setting(level, seed, rng), rng, low, high, apart=0.0 if level == "L3" else 4.0)


def one(at: Setting, rng: Rng, low: float, high: float, *, apart: float) -> Case:
    """One cause of a strength between the two; every other leaves `apart` of it or more."""
    chosen = pick([c for c in choices(at.arm) if shows(c, at)], rng)
    seen = view(at.world, at.train, at.noise)
    cause = tuned(seen, chosen.make(rng), float(np.exp(rng.uniform(np.log(low), np.log(high)))))
    if cause is None:
        raise NotThisTime(chosen.name)
    hidden = hide(at, cause, seen, blocks(seen, unit_causes(at.arm)))
    nearest = hidden.rivals[0]
    # pairs under 12 degrees and exact aliases are the business of L4 and L5
    if nearest.angle < PAIR or nearest.separation < apart:
        raise NotThisTime(f"{cause.name} looks like {nearest.name}")
    return at.case([cause], hidden=[hidden], note="" if at.plan == "usual" else at.plan)


def clean(level: str, seed: tuple[int, ...], rng: Rng) -> Case:
    """L0: nothing is hidden."""
    return setting(level, seed, rng).case([], expected="none")


def pair(level: str, seed: tuple[int, ...], rng: Rng) -> Case:
    """L4: a cause with a rival under 12 degrees apart that these data cannot rule out."""
    at = setting(level, seed, rng)
    options = [c for c in choices(at.arm) if shows(c, at)]
    seen = view(at.world, at.train, at.noise)
    table = blocks(seen, unit_causes(at.arm))
    for _ in range(12):
        chosen = pick(options, rng)
        cause = tuned(seen, chosen.make(rng), float(rng.uniform(8.0, 16.0)))
        if cause is None:
            continue
        hidden = hide(at, cause, seen, table)
        nearest = hidden.rivals[0]
        if 3.0 < nearest.angle < PAIR and 0.8 < nearest.separation < 2.4:
            return at.case(
                [cause], hidden=[hidden], expected="ambiguous",
                truth_extra={"pair": [f"{nearest.name}:{nearest.where}"]},
            )  # fmt: skip
    raise NotThisTime("no near pair")


def several(level: str, seed: tuple[int, ...], rng: Rng) -> Case:
    """L6: two to four causes at once, each still visible beyond the others."""
    at = setting(level, seed, rng)
    count = int(rng.integers(2, 5))
    causes, entries = together(at, rng, count, low=12.0, high=45.0, least=8.0, apart=4.0)
    return at.case(causes, hidden=entries, truth_extra={"count": count})


def together(
    at: Setting,
    rng: Rng,
    count: int,
    *,
    low: float,
    high: float,
    least: float,
    apart: float,
    pool: Sequence[Choice] | None = None,
) -> tuple[list[Cause], list[Hidden]]:
    """Causes of given strengths, each with at least `least` left beyond all the others' columns,
    and no single other candidate within `apart` of it.

    `pool`: causes whose laws are not the catalogue's; names of one family are then no rivals."""
    seen = view(at.world, at.train, at.noise)
    table = blocks(seen, unit_causes(at.arm))
    options = [c for c in (choices(at.arm) if pool is None else pool) if shows(c, at)]
    if not options:
        raise NotThisTime("nothing shows")
    kin = pool is not None
    causes: list[Cause] = []
    for _ in range(40):
        if len(causes) == count:
            break
        chosen = pick(options, rng)
        if any((chosen.name, chosen.where) == (c.name, c.where) for c in causes):
            continue
        if kin and any(c.name in GEAR and chosen.where == c.where for c in causes):
            continue  # one curve for each gear
        cause = tuned(seen, chosen.make(rng), float(np.exp(rng.uniform(*np.log((low, high))))))
        if cause is None:
            continue
        trial = [*causes, cause]
        if min(entry.left for entry in _crowd(seen, trial, table, kin)) >= least:
            entries = _crowd(seen, trial, table, kin)
            if min(entry.rivals[0].separation for entry in entries) >= apart:
                causes = trial
    if len(causes) < count:
        raise NotThisTime("no such set")
    return causes, _crowd(seen, causes, table, kin)


def _crowd(seen: View, causes: Sequence[Cause], table: Blocks, kin: bool = False) -> list[Hidden]:
    vectors = [signature(seen, cause) for cause in causes]
    own = {(c.name, c.where): k for k, c in enumerate(causes)}
    columns = dict(zip(table.names, table.columns, strict=True))
    out = []
    for k, cause in enumerate(causes):
        others = [
            columns.get((c.name, c.where), vectors[j][:, None])
            for j, c in enumerate(causes)
            if j != k
        ]
        known = np.concatenate(others, axis=1) if others else np.zeros((len(vectors[k]), 0))
        found = rivals(vectors[k], (cause.name, cause.where), table, known)
        rest = [r for r in found if (r.name, r.where) not in own and not nested_in(cause.name, r)]
        if kin:
            rest = [r for r in rest if r.where != cause.where or r.name not in family(cause.name)]
        left = beyond(vectors[k], known)
        out.append(Hidden(cause, float(np.linalg.norm(vectors[k])), left, rest))
    return out


Builder = Callable[[str, tuple[int, ...], Rng], Case]


def unseen_arm(rng: Rng) -> tuple[Arm, str | None]:
    """Mostly an arm made up on the spot."""
    if rng.random() < 0.75:
        return random_arm(rng)
    arm = [sk120, six_axis, telescope][rng.choice(3)]()
    return arm, urdf_text(arm)
