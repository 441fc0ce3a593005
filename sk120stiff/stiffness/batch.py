"""Stiffness at very many poses, by the compiled kernel on all cores."""

from __future__ import annotations

import logging
import os
import threading
from collections.abc import Callable, Collection, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sk120stiff.arrays import Array, Integers
from sk120stiff.errors import InputError
from sk120stiff.robot import Mechanism, Robot
from sk120stiff.stiffness.equilibrium import Weight
from sk120stiff.stiffness.lanes.folding import Fold, fold

logger = logging.getLogger(__name__)

Classes = NDArray[np.uint8]
LARGEST_ANGLE = 1e5  # rad; beyond it sine and cosine lose digits
PIECE = 16384  # poses that a thread takes at a time
PATIENCE = 0.5  # seconds after which the preparation is announced
_READY: list[Any] = []  # the compiled function and the type of its outputs, once they are loaded

#: What `stiffness_batch` can compute.
QUANTITIES = (
    "position",
    "rotation",
    "jacobian",
    "condition",
    "compliance",
    "values",
    "directions",
    "K_C",
    "stiffness_class",
    "complementary_class",
    "critical",
)

BY_LOAD = frozenset(QUANTITIES) - {"position", "rotation", "jacobian", "condition"}


@dataclass(frozen=True, eq=False)
class StiffnessBatch:
    """What was asked for, at N poses; what was not asked for is None.

    With Q loads at every pose the load comes first: (Q, N, …) wherever the load matters.

    Attributes
    ----------
    soft
        (s,) indices of the coordinates with a finite spring.
    position
        (N, 3) of the point [m].
    rotation
        (N, 3, 3) of the end frame.
    jacobian
        (N, 6, n) of the point by all coordinates, [linear; angular], base axes.
    condition
        (N,) smallest over largest singular value of the position Jacobian of the actuated joints;
        0 where a direction is lost.
    compliance
        (N, 3, 3) J (K_θ − K_C)⁻¹ Jᵀ [m/N]; NaN where K_θ − K_C is singular.
    values, directions
        (N, 3) principal stiffness [N/m] and (N, 3, 3) unit directions, one per row, ordered as
        `Principal`.
    K_C
        (N, s, s) complementary stiffness of the soft coordinates [N·m/rad].
    stiffness_class, complementary_class
        (N,) definiteness of K_θ − K_C and of K_C, as indices into `CLASSES`.
    critical
        (N,) factor on the load at which stability is lost, see `critical_load`.
    """

    soft: Integers
    position: Array | None = None
    rotation: Array | None = None
    jacobian: Array | None = None
    condition: Array | None = None
    compliance: Array | None = None
    values: Array | None = None
    directions: Array | None = None
    K_C: Array | None = None
    stiffness_class: Classes | None = None
    complementary_class: Classes | None = None
    critical: Array | None = None

    def of(self, quantity: str) -> NDArray[Any]:
        """A quantity that was asked for.

        Raises
        ------
        KeyError
            It was not.
        """
        found = getattr(self, quantity, None)
        if found is None:
            raise KeyError(quantity)
        return np.asarray(found)


def stiffness_batch(
    robot: Robot | Mechanism,
    a: ArrayLike,
    springs: ArrayLike,
    wrench: ArrayLike,
    *,
    frame: str | None = None,
    point: ArrayLike | None = None,
    virtual: ArrayLike | None = None,
    weight: Weight | None = None,
    want: Collection[str] = ("position", "compliance", "values", "stiffness_class"),
    threads: int | None = None,
) -> StiffnessBatch:
    """Stiffness of a point at many poses: the formulas of this package, compiled.

    Parameters
    ----------
    robot
        A robot, or a mechanism with its virtual joints; the coupling must be linear.
    a
        (N, n_a) actuated coordinates [rad or m].
    springs
        (n,) spring of every coordinate [N·m/rad or N/m], infinite where rigid; or (n, n) their
        symmetric K_θ.
    wrench
        (6,) or (3,) force [N] and moment [N·m] at the point in base axes, the same at all poses;
        (N, 6) one for each pose; or (Q, 1, 6) every one of Q loads at every pose.
    frame
        Frame that carries the point, for a robot; its tool frame by default.
    point
        (3,) in that frame [m]; its origin by default.
    virtual
        (n_v,) where the virtual joints stand [rad or m]; zero by default.
    weight
        Lets the arm sag under its own weight before the load comes; all results hold at the pose
        that it sags to, and are NaN where the springs cannot hold the weight.
    want
        What to compute, of `QUANTITIES`.
    threads
        Number of threads; one per available core by default.

    Raises
    ------
    InputError
        Shapes do not fit, or a number is not finite.
    """
    mechanism = robot.mechanism(frame) if isinstance(robot, Robot) else robot
    at = np.zeros(3) if point is None else np.asarray(point, dtype=float)
    if at.shape != (3,) or not np.isfinite(at).all():
        raise InputError("the point is not three finite numbers", remedy="Give x, y, z in metres.")
    still = np.zeros(len(mechanism.virtual)) if virtual is None else np.asarray(virtual, float)
    folded = fold(mechanism, np.asarray(springs, dtype=float), at, still, weight)
    return run_folded(folded, a, wrench, want, threads=threads)


def run_folded(
    folded: Fold,
    a: ArrayLike,
    wrench: ArrayLike,
    want: Collection[str],
    *,
    threads: int | None = None,
) -> StiffnessBatch:
    """`stiffness_batch` for a mechanism that is folded already, which saves most of a short call.

    Raises
    ------
    InputError
        Shapes do not fit, or a number is not finite.
    """
    poses = _poses(a, folded)
    loads, several = _loads(wrench, len(poses))
    unknown = set(want) - set(QUANTITIES)
    if unknown:
        raise InputError(
            f"{', '.join(sorted(unknown))} cannot be computed",
            remedy=f"Choose from {', '.join(QUANTITIES)}.",
        )
    found: dict[str, Any] = _run(
        folded, poses, loads, frozenset(want), threads or available_cores()
    )
    if not several:
        found |= {name: found[name][0] for name in BY_LOAD & found.keys()}
    return StiffnessBatch(soft=folded.soft, **found)


def available_cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _poses(a: ArrayLike, folded: Fold) -> Array:
    poses = np.ascontiguousarray(a, dtype=float)
    n = folded.actuated
    if poses.ndim != 2 or poses.shape[1] != n:
        raise InputError(
            f"poses of shape {poses.shape} given, but this mechanism has {n} actuated coordinates",
            remedy=f"Give an array of shape (N, {n}).",
        )
    if not poses.size:
        return poses
    # One pass without copies settles nearly every call; only a doubt looks at each joint.
    reach = max(float(poses.max()), -float(poses.min()))
    angles = np.abs(folded.pose_map[:, :n]).sum(axis=1)[folded.slides == 0.0]
    if np.isfinite(reach) and reach * angles.max(initial=0.0) <= LARGEST_ANGLE:
        return poses
    largest = np.abs(poses).max(axis=0, initial=0.0)
    if not np.isfinite(largest).all():
        raise InputError(
            "a joint coordinate is not a finite number",
            where=f"pose {int(np.flatnonzero(~np.isfinite(poses).all(axis=1))[0])}",
        )
    turning = (np.abs(folded.pose_map[:, :n]) @ largest)[folded.slides == 0.0]
    if turning.max(initial=0.0) > LARGEST_ANGLE:
        raise InputError(
            f"a joint angle of {turning.max():.3g} rad is beyond {LARGEST_ANGLE:.0e}",
            remedy="Give joint angles in radians.",
        )
    return poses


def _loads(wrench: ArrayLike, count: int) -> tuple[Array, bool]:
    """Loads as (1, 1, 6), (1, N, 6) or (Q, 1, 6), and whether there are several at each pose."""
    given = np.asarray(wrench, dtype=float)
    if given.shape == (3,):
        given = np.concatenate([given, np.zeros(3)])
    several = given.ndim == 3 and given.shape[1] == 1
    if given.shape[-1:] != (6,) or not (several or given.shape in ((6,), (count, 6))):
        raise InputError(
            f"loads of shape {given.shape} given for {count} poses",
            remedy=f"Give (6,), ({count}, 6), or (Q, 1, 6) for Q loads at every pose.",
        )
    if not np.isfinite(given).all():
        raise InputError("a load is not a finite number", remedy="Check forces and moments.")
    if several:
        return np.ascontiguousarray(given), True
    return np.ascontiguousarray(given.reshape(1, -1, 6)), False


def _run(
    folded: Fold, poses: Array, loads: Array, want: frozenset[str], threads: int
) -> dict[str, NDArray[np.generic]]:
    """Fill the wanted arrays, in pieces shared out to threads."""
    count, quantity, n, s = len(poses), len(loads), len(folded.rest), len(folded.soft)
    shapes: dict[str, tuple[int, ...]] = {
        "position": (count, 3),
        "rotation": (count, 3, 3),
        "jacobian": (count, 6, n),
        "condition": (count,),
        "compliance": (quantity, count, 3, 3),
        "values": (quantity, count, 3),
        "directions": (quantity, count, 3, 3),
        "K_C": (quantity, count, s, s),
        "stiffness_class": (quantity, count),
        "complementary_class": (quantity, count),
        "critical": (quantity, count),
    }
    arrays = {
        name: np.zeros(
            shape if name in want else (0,) * len(shape),
            dtype=np.uint8 if name.endswith("_class") else float,
        )
        for name, shape in shapes.items()
    }
    work, out = _kernel(folded, poses, loads, arrays)
    pieces = range(0, count, PIECE)
    if threads == 1 or len(pieces) == 1:
        work(folded, poses, loads, 0, count, out)
    else:
        with ThreadPoolExecutor(threads) as pool:
            done = [
                pool.submit(work, folded, poses, loads, begin, min(begin + PIECE, count), out)
                for begin in pieces
            ]
            for one in done:
                one.result()
    return {name: arrays[name] for name in shapes if name in want}


def _kernel(
    folded: Fold, poses: Array, loads: Array, arrays: dict[str, Any]
) -> tuple[Callable[..., None], Any]:
    """The compiled function and its outputs; the first call in a process loads or compiles it."""
    if _READY:
        work, outputs = _READY
        return work, outputs(**arrays)
    with announced():
        from sk120stiff.stiffness.lanes.block import Outputs, work

        out = Outputs(**arrays)
        work(folded, poses, loads, 0, 0, out)  # nothing to do but to be compiled or loaded
        _READY[:] = [work, Outputs]
    return work, out


@contextmanager
def announced() -> Iterator[None]:
    """Say so when what happens inside takes long: it compiles, or the machine is busy."""
    message = "Preparing the batch kernel (some ten seconds at its first use on a machine) …"
    clock = threading.Timer(PATIENCE, logger.info, args=(message,))
    clock.daemon = True
    clock.start()
    try:
        yield
    finally:
        clock.cancel()
