"""L11: absolute positions in an unknown frame of an arm whose geometry is off, elastic or not."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from .arm import Arm
from .causes_elastic import JointTilt, LinkBending
from .draw import around
from .levels import NotThisTime, Rng
from .position_case import PositionCase, Seen
from .positions import Truth, Visits
from .robots import random_arm, six_axis, urdf_text
from .rotations import Array
from .signature import ONE_SIGNED, orthonormal, short_of
from .world import Cause

SHOWS = 8.0  # standard sizes that a cause must leave beside all others to be asked for
APART = 5.0  # the same, that no other name may come nearer
SERIES, LOADED = 2, 0.5  # of series, and share of campaigns with payloads
STEP = 1e-3  # of a usual size, for derivatives


@dataclass(frozen=True)
class Candidate:
    """One cause that may be hidden or be taken for what is: how a size of it changes the truth."""

    name: str
    where: str
    sizes: tuple[float, ...]  # usual ones
    put: Callable[[Truth, Array], Truth]

    @property
    def key(self) -> tuple[str, str]:
        return self.name, self.where


def candidates(arm: Arm, visits: Visits, *, yields: bool) -> list[Candidate]:
    """Every cause at every place that these visits could show; no geometry."""
    t = arm.typical
    turning = [name for name in arm.actuated if not arm.slides(name)]
    pairs = [
        f"{first},{second}" for k, first in enumerate(turning) for second in turning[k + 1 : k + 3]
    ]
    still = len(np.unique(visits.pose)) == visits.count  # no jitter that hides the last movement
    warms = np.ptp(visits.temperature) > 0.0
    out = []
    if yields:
        out += [Candidate("joint_springs", n, (1.0 / t.joint[n],), _spring(n)) for n in turning]
        out += [Candidate("joint_tilt", n, (1.0 / t.tilt,) * 2, _tilt(n)) for n in turning]
        out += [
            Candidate("link_bending", n, (1.0 / t.bending,) * 2, _beam(n)) for n in arm.long_links()
        ]
        out.append(Candidate("payload", arm.tool_frame, (1.0, 0.1, 0.1, 0.1), _load))
    out += [Candidate("transmission_error", n, (2e-4,) * 4, _wave(n)) for n in turning]
    out += [Candidate("joint_coupling", pair, (3e-4,), _coupled(pair)) for pair in pairs]
    out += [Candidate("lost_motion", n, (1e-4,), _played(n)) for n in turning]
    if still:
        out += [Candidate("approach_side", n, (5e-5,), _sided(n)) for n in turning]
    if warms:
        out += [Candidate("thermal_growth", n, (1.2e-5,), _grown(n)) for n in arm.long_links()]
    if visits.series.any():
        out.append(Candidate("marker_shift", arm.tool_frame, (5e-4,) * 3, _remounted))
    return out


def _spring(name: str) -> Callable[[Truth, Array], Truth]:
    return lambda truth, size: replace(truth, compliance=_more(truth.compliance, name, size))


def _tilt(name: str) -> Callable[[Truth, Array], Truth]:
    def put(truth: Truth, size: Array) -> Truth:
        return _softer(truth, [JointTilt(name, dict(zip(("first", "second"), size, strict=True)))])

    return put


def _beam(link: str) -> Callable[[Truth, Array], Truth]:
    def put(truth: Truth, size: Array) -> Truth:
        return _softer(
            truth,
            [LinkBending(link, {"flexibility": float(s)}, {"only": k, "taper": 0.3})
             for k, s in enumerate(size)],
        )  # fmt: skip

    return put


def _softer(truth: Truth, causes: Sequence[Cause]) -> Truth:
    """The same parts softer by as much, other parts beside them."""
    soft = list(truth.soft)
    for cause in causes:
        for k, own in enumerate(soft):
            if (own.name, own.where, own.options) == (cause.name, cause.where, cause.options):
                sizes = {key: own.size(key) + cause.size(key) for key in cause.sizes}
                soft[k] = replace(own, sizes=sizes)
                break
        else:
            soft.append(cause)
    return replace(truth, soft=tuple(soft))


def _load(truth: Truth, size: Array) -> Truth:
    return replace(truth, load=truth.load + size)


def _wave(name: str) -> Callable[[Truth, Array], Truth]:
    def put(truth: Truth, size: Array) -> Truth:
        own = truth.waves.get(name, np.zeros(4)) + size
        return replace(truth, waves={**truth.waves, name: own})

    return put


def _coupled(pair: str) -> Callable[[Truth, Array], Truth]:
    return lambda truth, size: replace(truth, coupling=_more(truth.coupling, pair, size))


def _sided(name: str) -> Callable[[Truth, Array], Truth]:
    return lambda truth, size: replace(truth, side=_more(truth.side, name, size))


def _played(name: str) -> Callable[[Truth, Array], Truth]:
    return lambda truth, size: replace(truth, play=_more(truth.play, name, size))


def _grown(link: str) -> Callable[[Truth, Array], Truth]:
    return lambda truth, size: replace(truth, growth=_more(truth.growth, link, size))


def _more(sizes: Mapping[str, float], key: str, size: Array) -> dict[str, float]:
    return {**sizes, key: sizes.get(key, 0.0) + float(size[0])}


def _remounted(truth: Truth, size: Array) -> Truth:
    return replace(truth, remount=truth.remount + size)


def geometry(truth: Truth, visits: Visits) -> Array:
    """(3N, k) derivatives by the tracker's frame, the marker and every joint's frame."""
    ways: list[Truth] = []
    for axis in np.eye(3):
        ways += [replace(truth, **{key: getattr(truth, key) + 1e-6 * axis})
                 for key in ("turn", "shift", "marker")]  # fmt: skip
    for joint in truth.arm.joints:
        own = truth.frames.get(joint.name, np.zeros(6))
        ways += [
            replace(truth, frames={**truth.frames, joint.name: own + 1e-6 * axis})
            for axis in np.eye(6)
        ]
    start = truth.positions(visits)
    return np.stack([(way.positions(visits) - start).ravel() for way in ways], axis=1) / 1e-6


def columns(truth: Truth, visits: Visits, cause: Candidate) -> Array:
    """(3N, p) change by usual sizes of a cause, to first order, as if it stood alone."""
    start = truth.positions(visits)
    out = []
    for k, size in enumerate(cause.sizes):
        step = np.zeros(len(cause.sizes))
        step[k] = STEP * size
        out.append((cause.put(truth, step).positions(visits) - start).ravel() / STEP)
    return np.stack(out, axis=1)


def visits_of(arm: Arm, rng: Rng, poses: int, *, loads: tuple[float, ...], twice: bool,
              warm: float, series: int, hung: Array) -> Visits:  # fmt: skip
    """Random poses; encoder values of one pose differ by up to a milliradian."""
    rows = len(loads) if len(loads) > 1 else (2 if twice else 1)
    pose = np.repeat(np.arange(poses), rows)
    values = {}
    for name in arm.actuated:
        low, high = np.array(arm.limits[name])
        middle, half = 0.5 * (low + high), 0.45 * min(high - low, 4.5)
        q = np.repeat(rng.uniform(middle - half, middle + half, poses), rows)
        if rows > 1:
            q = q + np.clip(rng.normal(0.0, 2e-4, len(q)), -4e-4, 4e-4)
        values[name] = q
    count = len(pose)
    payload = np.tile(np.array(loads), poses) if len(loads) > 1 else np.full(count, loads[0])
    late = np.arange(count) / count
    return Visits(
        pose, values, payload, warm * (1.0 - np.exp(-2.0 * late)),
        np.floor(series * late).astype(int), hung,
    )  # fmt: skip


def positions(level: str, seed: tuple[int, ...], rng: Rng) -> PositionCase:
    """L11.rigid: geometry alone. L11: springs under weight or none, and up to two other causes."""
    arm, text = random_arm(rng) if rng.random() < 0.6 else (six_axis(), "")
    if any(arm.slides(name) for name in arm.actuated) or not arm.has_mass:
        raise NotThisTime("slides, or has no weight")
    scale = (arm.typical.force / 300.0) ** 0.5  # of lengths, against an arm of 2 m
    wide = {
        "loads": (0.0, 40.0 * scale**2) if rng.random() < LOADED else (0.0,),
        "twice": bool(rng.random() < 0.3),
        "warm": 6.0 if rng.random() < 0.4 else 0.0,
        "series": SERIES if rng.random() < 0.4 else 1,
        "hung": 0.1 * rng.normal(size=3),
    }
    if wide["loads"] == (0.0,):
        wide["hung"] = np.zeros(3)  # no payload is stated: a file says of none where it hangs
    train = visits_of(arm, rng, int(rng.integers(60, 120)), **wide)
    others = [visits_of(arm, rng, 20, **wide) for _ in range(2)]
    size = 3e-4 * float(np.exp(rng.normal(0.0, 0.4)))
    truth = Truth(
        arm, turn=rng.normal(size=3), shift=rng.uniform(-3.0, 3.0, 3),
        marker=0.1 * rng.normal(size=3),
        frames={joint.name: size * rng.normal(size=6) for joint in arm.joints},
    )  # fmt: skip
    sigma = float(np.exp(rng.uniform(np.log(1e-5), np.log(4e-5))))
    hidden: list[Candidate] = []
    yields = level == "L11" and rng.random() < 0.7
    pool = candidates(arm, train, yields=yields)
    if yields:
        hidden = [c for c in pool if c.name == "joint_springs"]
    if level == "L11":
        usual = [c for c in pool if c.name not in ("joint_springs", "joint_tilt")]
        kinds = list(dict.fromkeys(c.name for c in usual))
        for kind in rng.choice(kinds, size=int(rng.integers(0 if yields else 1, 3)), replace=False):
            own = [c for c in usual if c.name == kind]
            hidden.append(own[int(rng.integers(len(own)))])
    sizes = []
    for cause in hidden:
        usual_size = np.array([around(rng, s) for s in cause.sizes])
        if cause.name not in (*ONE_SIGNED, "lost_motion"):
            usual_size *= rng.choice([-1.0, 1.0], len(usual_size))
        sizes.append(usual_size)
        truth = cause.put(truth, usual_size)
    seen = _seen(truth, train, hidden, sizes, sigma, candidates(arm, train, yields=True))
    return PositionCase(
        level=level, seed=seed, truth_=truth, train=train, holdout=others[0], sealed=others[1],
        sigma=sigma, stated=bool(rng.random() < 0.8), hidden=seen,
        rough=truth.marker + 5e-3 * rng.normal(size=3),
        urdf=text or str(urdf_text(arm)),
    )  # fmt: skip


def _seen(truth: Truth, visits: Visits, hidden: list[Candidate], sizes: list[Array], sigma: float,
          pool: list[Candidate]) -> list[Seen]:  # fmt: skip
    """What each hidden cause leaves beside geometry and the others, and what comes nearest."""
    base = orthonormal(geometry(truth, visits))

    def less(block: Array, basis: Array) -> Array:
        return block - basis @ (basis.T @ block)

    known = {c.key: c for c in hidden}
    table = {c.key: less(columns(truth, visits, c), base) / sigma for c in pool}
    out = []
    for cause, size in zip(hidden, sizes, strict=True):
        change = table[cause.key] @ (size / np.array(cause.sizes))
        rest = [table[key] for key in known if key != cause.key]
        others = orthonormal(np.concatenate(rest, axis=1)) if rest else np.zeros((len(change), 0))
        alone = less(change, others)
        left = float(np.linalg.norm(alone))
        rivals = sorted(
            (short_of(alone, less(block, others), key[0]), *key)
            for key, block in table.items()
            if key not in known
        )
        asked = left >= SHOWS and rivals[0][0] >= APART
        if cause.name == "marker_shift":  # a file that tells of series asks for it
            asked = False
        elif cause.name != "joint_springs" and not asked:
            raise NotThisTime(f"{cause.name} does not show")
        seen = float(np.linalg.norm(change))
        out.append(Seen(cause.name, cause.where, size, seen, left, asked, rivals[:5]))
    return out
