"""Readings that no fit saw, of a tracker that has moved since: its frame is found anew, and told.

Whoever verifies a calibration sets the tracker up again, and mounts the marker again. What is left
of the gap beside that is what the calibration is worth.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.effects import LoadCases, Viewpoint, load_cases_of
from sk120stiff.errors import micro
from sk120stiff.identify.positions.checks.parts import FAR, by_stations
from sk120stiff.identify.positions.solve.start import REGISTERED, options_of
from sk120stiff.measurements import Measurements
from sk120stiff.measurements.placing.placing import stands_for_all
from sk120stiff.measurements.placing.registration import Registration, register
from sk120stiff.model import Model, Parameter
from sk120stiff.model.pose_reading import read_poses
from sk120stiff.robot.rotations import rotation_vector

BETTER = 0.2  # of what is left, below which it must fall: no error of a model moves a cloud so
STEPS = 3  # of Gauss and Newton, because an instrument may misread what it sees from there
ROUNDS = 5  # of leaving such rows out
FEWEST = 5  # whole positions of a station: three would fit in any case, nearly
OF_MARKER = 8  # the same where the marker's place is sought as well


@dataclass(frozen=True, eq=False)
class PlacedAnew:
    """A model with the tracker where these readings have it.

    Attributes:
        model: The model with other frames, and the marker elsewhere where that is needed.
        readings: They, with the stations told that the model knows.
        marker: Has the marker moved as well?
        before, after: Median distance of positions without and with it [m]; `before` is NaN where
            the model knows nothing of a station.
        parts: Which rows were taken for which station of the model; "": none had to be.
    """

    model: Model
    readings: Measurements
    marker: bool
    before: float
    after: float
    parts: str = ""

    def sentence(self) -> str:
        """What was done, and why."""
        if self.parts:
            return self.parts
        what = "The tracker" + (" and the marker" if self.marker else "")
        told = (
            f": {1e3 * self.before:.4g} mm are left (median) where the fit had "
            f"{'them' if self.marker else 'it'}, {micro(self.after)} µm where these readings do."
            if np.isfinite(self.before)
            else ": the model knows nothing of this station, which is found from these readings "
            f"({micro(self.after)} µm are left in the median)."
        )
        verb = "sit elsewhere" if self.marker else "stands elsewhere"
        return (
            f"{what} {verb} in these readings{told} Errors that a new place takes up do not show."
        )


def placed_anew(model: Model, readings: Measurements) -> PlacedAnew | None:
    """The model with frames of its own for these readings; None where it knows the tracker's.

    A frame that the model knows stays unless another leaves less than `BETTER` of the gap.
    With a station that it does not know all stations of these readings are placed anew. Where the
    file names none and the model knows several, each row is told the one that it fits.

    Raises:
        InputError: Too few positions were read from a station that the model does not know.
    """
    said = readings.absolute
    views = [effect for effect in model.effects if isinstance(effect, Viewpoint)]
    if said is None or said.frame == "base" or said.channels.position is None or len(views) != 1:
        return None
    model, view = model.under(readings.gravity), views[0]
    whole = np.isfinite(said.channels.position).all(axis=1) & readings.use
    labels, stood = said.stood
    known = dict.fromkeys(
        p.spec.name.rpartition(".")[0] for p in model.parameters if p.effect is view
    )
    strange = not set(labels) <= set(known)
    rows = load_cases_of(model.robot, readings).rows(np.flatnonzero(whole))
    x = said.channels.position[whole]
    several = strange and len(known) > 1
    parts = by_stations(model, readings, list(known), rows, whole) if several else None
    if strange and parts is None:
        stands_for_all(labels, stood[whole], readings)
    fewest = np.bincount(stood[whole], minlength=len(labels)).min()
    if fewest < FEWEST and not strange:
        return None
    before = np.nan
    if not strange:
        before = float(np.median(np.linalg.norm(x - read_poses(model, rows).position, axis=1)))
    bare, best = model.without(view.id), None
    goal = np.inf if strange else BETTER * before
    if parts is not None:
        goal, told = BETTER * parts.left, parts.readings
        best = PlacedAnew(model, told, False, parts.left, parts.left, parts.sentence)
        if fewest < FEWEST:
            return best
    for marker in (False, True)[: 1 + (fewest >= OF_MARKER)]:
        found = _trimmed(bare, rows, x, stood[whole], fit_marker=marker)
        moved = None if found is None else _moved(model, view, found, readings)
        if moved is None:
            continue
        moved, after = _refined(moved, view.id, rows, x, marker=marker)
        if after < goal:
            goal = BETTER * after
            best = PlacedAnew(_with_doubt(moved, model), readings, marker, before, after)
    return best


def _trimmed(
    bare: Model, rows: LoadCases, x: Array, stood: Index, *, fit_marker: bool
) -> Registration | None:
    """The model's marker laid onto positions (N, 3), without rows far off all others."""
    seen = read_poses(bare, rows)
    kept: Mask = np.ones(len(x), dtype=bool)
    zero, found = np.zeros(3), None
    for _ in range(ROUNDS):
        again = register(
            x[kept], seen.position[kept], seen.standing[kept], zero,
            fit_marker=fit_marker, station=stood[kept],
        )  # fmt: skip
        if again is None or again.marker_fitted != fit_marker:
            break
        found = again
        at = seen.position + seen.standing @ found.marker
        left = np.linalg.norm(x - found.seen(at, stood), axis=1)
        near = left <= max(FAR * float(np.median(left)), 1e-9)
        if (near == kept).all():
            break
        kept = near
    return found


def _moved(
    model: Model, view: Viewpoint, found: Registration, readings: Measurements
) -> Model | None:
    """The model with the frames that were found, and its marker moved; None where it has none."""
    options = options_of(readings)
    there = type(view).at(model.robot, view.where, options)
    values = np.concatenate([found.shifts, rotation_vector(found.turns)], axis=1).ravel()
    if len(there.parameters) != len(values):
        return None
    frame = tuple(
        Parameter(there, spec, float(value), free=False, origin=REGISTERED)
        for spec, value in zip(there.parameters, values, strict=True)
    )
    parameters = [p for p in model.parameters if p.effect is not view]
    if found.marker_fitted:
        offsets = [p for p in parameters if p.effect.name == "tool_offset"]
        if len(offsets) != 3:
            return None
        for p, more in zip(offsets, found.marker, strict=True):
            parameters[parameters.index(p)] = replace(p, internal=p.internal + float(more))
    return replace(model, parameters=(*parameters, *frame), uncertainty=None)


def _refined(
    model: Model, view: str, rows: LoadCases, x: Array, *, marker: bool
) -> tuple[Model, float]:
    """The same to the end, with what the instrument misreads from there; median distance [m]."""
    moves = [
        k
        for k, p in enumerate(model.parameters)
        if p.effect.id == view or (marker and p.effect.name == "tool_offset")
    ]
    for _ in range(STEPS):
        seen = read_poses(model, rows, derivative=True)
        left = x - seen.position
        far = np.linalg.norm(left, axis=1)
        near = far <= max(FAR * float(np.median(far)), 1e-9)
        slope = seen.columns[near, :3][:, :, moves].reshape(-1, len(moves))
        step = np.linalg.lstsq(slope, left[near].ravel(), rcond=1e-12)[0]
        values = model.values.copy()
        values[moves] += step
        model = model.with_values(values)
    far = np.linalg.norm(x - read_poses(model, rows).position, axis=1)
    return model, float(np.median(far))


def _with_doubt(moved: Model, model: Model) -> Model:
    """The model with what is known of its other parameters."""
    known = model.uncertainty
    if known is None:
        return moved
    as_before = {
        new.name
        for new in moved.parameters
        if new.name in model.names and new.internal == model.parameter(new.name).internal
    }
    kept = [k for k, name in enumerate(known.names) if name in as_before]
    return moved.known(
        replace(
            known,
            names=tuple(known.names[k] for k in kept),
            values=known.values[kept],
            covariance=known.covariance[np.ix_(kept, kept)],
            unseen=known.unseen[:, kept],
        )
    )
