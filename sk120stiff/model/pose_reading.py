"""Where a marker stands and how the tool is turned, as an instrument with axes of its own sees it.

x = S(R(p) X(z) + t), with X the marker in base axes at the equilibrium z under weight, payload and
load, R and t the instrument's frame (`Viewpoint`), and S what it misreads (`ReadingError`). Axes
that are read are those of a target, which may be turned on the tool (`Mounting`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import LoadCases, Mounting, ReadingError, Viewpoint
from sk120stiff.measurements.channels import Moved
from sk120stiff.model.assembly import Assembly
from sk120stiff.model.misread import misread
from sk120stiff.model.model import Model
from sk120stiff.model.sensitivities import moving_sensitivities, pose_sensitivities

BLOCK = 512  # readings solved together; memory stays linear in their number
BUDGET = 2_000_000  # numbers in one (block, n, n) array


@dataclass(frozen=True, eq=False)
class PoseReading:
    """Poses as read.

    Attributes:
        position, rotation: (N, 3) marker [m] and (N, 3, 3) axes of the target, axes of the
            instrument.
        columns: (N, 6, P) derivative of position and orientation by the internal parameter values,
            in axes of the instrument; no parameters where nobody asked.
        standing, turning: (N, 3, 3) tool axes and (N, 3, P) how they turn, base axes.
    """

    position: Array
    rotation: Array
    columns: Array
    standing: Array
    turning: Array


def read_poses(
    model: Model, load_cases: LoadCases, values: Array | None = None, *, derivative: bool = False
) -> PoseReading:
    """Predicted positions and orientations of N readings, in blocks.

    Raises:
        Refusal: The springs cannot hold the arm's weight or a load.
    """
    given = model.values if values is None else values
    parts = [
        _read(model.assembly, part, given, derivative)
        for part in _blocks(load_cases, model.assembly.mechanism.n)
    ]
    names = ("position", "rotation", "columns", "standing", "turning")
    return PoseReading(*(np.concatenate([getattr(part, n) for part in parts]) for n in names))


def move_by_load(
    model: Model, load_cases: LoadCases, values: Array | None = None, *, derivative: bool = False
) -> Moved:
    """Predicted displacements of the marker, and rotations of the tool, by N loads, in blocks.

    What an instrument misreads is in the displacements alone.

    Raises:
        Refusal: The springs cannot hold the arm's weight or a load.
    """
    given = model.values if values is None else values
    found: list[Moved] = []
    for part in _blocks(load_cases, model.assembly.mechanism.n):
        solution = model.assembly.solve(part, given)
        axes = part.reading_axes
        columns = np.zeros((part.count, 6, 0))
        if derivative:
            columns = moving_sensitivities(model.assembly, solution, given)
        turn = np.swapaxes(axes, -1, -2) @ solution.turn @ axes
        found.append(Moved(solution.displacement, turn, columns))
    names = ("displacement", "rotation", "columns")
    return Moved(*(np.concatenate([getattr(part, n) for part in found]) for n in names))


def instrument_frames(model: Model, load_cases: LoadCases) -> tuple[Array, Array]:
    """(N, 3, 3) rotations and (N, 3) origins [m] of base axes as the instrument sees them.

    Raises:
        InputError: It stood where the model does not know of.
    """
    return _frames(model.assembly, load_cases, model.values)


def _frames(assembly: Assembly, load_cases: LoadCases, values: Array) -> tuple[Array, Array]:
    R, t = np.tile(np.eye(3), (load_cases.count, 1, 1)), np.zeros((load_cases.count, 3))
    for effect, part in zip(assembly.effects, assembly.slices, strict=True):
        if isinstance(effect, Viewpoint):
            own, shift = effect.frames(load_cases, values[part])
            R, t = own @ R, np.einsum("nij,nj->ni", own, t) + shift
    return R, t


def _blocks(load_cases: LoadCases, n: int) -> Iterator[LoadCases]:
    size = max(1, min(BLOCK, BUDGET // n**2))
    for k in range(0, load_cases.count, size):
        yield load_cases.rows(slice(k, k + size))


def _read(
    assembly: Assembly, load_cases: LoadCases, values: Array, derivative: bool
) -> PoseReading:
    stood = assembly.stand(load_cases, values)
    screws = stood.rest.screws
    R, t = _frames(assembly, load_cases, values)
    effects = list(zip(assembly.effects, assembly.slices, strict=True))
    views = [(effect, part) for effect, part in effects if isinstance(effect, Viewpoint)]
    turned = np.einsum("nij,nj->ni", R, screws.position)
    said = misread(assembly.of(ReadingError), load_cases, values, turned + t)
    P = len(values) if derivative else 0
    columns = np.zeros((load_cases.count, 6, P))
    turning = columns[:, 3:]
    if derivative:
        body = pose_sensitivities(assembly, stood, values)
        turning = body[:, 3:]
        columns[:, :3], columns[:, 3:] = R @ body[:, :3], R @ body[:, 3:]
        for effect, part in views:
            columns[:, :, part] += effect.columns(load_cases, turned, values[part])
        columns[:, :3] = said.matrix @ columns[:, :3]
        for part, own in said.columns:
            columns[:, :3, part] += own
    rotation = R @ screws.rotation
    for target, part in effects:
        if isinstance(target, Mounting):
            turn, own = target.turned(load_cases, values[part])
            if derivative:
                columns[:, 3:, part] = rotation @ own
            rotation = rotation @ turn
    return PoseReading(said.value, rotation, columns, screws.rotation, turning)
