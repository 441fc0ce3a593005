"""Predictions with what is known of their uncertainty, row by row as a file has them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array, Mask
from sk120stiff.effects import LoadCases, Viewpoint, load_cases_of
from sk120stiff.errors import InputError, Refusal, warn
from sk120stiff.files import html_table
from sk120stiff.measurements import Measurements, as_displacements
from sk120stiff.measurements.channels import inclined
from sk120stiff.measurements.directions import in_the_frame
from sk120stiff.model.channel_columns import (
    AXES,
    of_gauges,
    of_turns,
    of_wires_and_levels,
    vectors_read,
)
from sk120stiff.model.counted_from import warn_of_references
from sk120stiff.model.holding import held_loads
from sk120stiff.model.model import Model
from sk120stiff.model.pose_reading import move_by_load, read_poses
from sk120stiff.model.uncertainty import HIDDEN, Uncertainty, spread
from sk120stiff.robot.rotations import rotation_vector


@dataclass(frozen=True, eq=False)
class Predicted:
    """Predicted readings of N poses and loads.

    Attributes:
        displacement: (N, 3) by which loads move the point, in the axes of the measurements [m].
        std_parameters: (N, 3) standard uncertainty from that of the parameters [m]; infinite where
            a value counts that the readings of the fit do not show. None: the model stores no
            uncertainty.
        std_remainder: (N, 3) standard size of what the model leaves unexplained [m]; None where
            that is not known.
        blame: For every reading the names of the parameters that make its uncertainty infinite.
        position, rotation: (N, 3) where the marker stands [m] and (N, 3, 3) axes that are read, the
            tool's or a target's, in the axes of the instrument; None where displacements were read.
        turn: (N, 3) rotation vector of the tool from its axes without load to those with it, axes
            of the displacements [rad]; None where none was read.
        inclination: (N,) of the level above the horizon [rad]; None where none was read.
    """

    displacement: Array
    std_parameters: Array | None = None
    std_remainder: Array | None = None
    blame: tuple[tuple[str, ...], ...] = ()
    position: Array | None = None
    rotation: Array | None = None
    turn: Array | None = None
    inclination: Array | None = None

    def __repr__(self) -> str:
        if self.position is not None:
            return f"<Predicted: {len(self.position)} positions>"
        largest = 1e6 * float(np.linalg.norm(self.displacement, axis=1).max(initial=0.0))
        known = "without ±" if self.std_parameters is None else "with ±"
        return f"<Predicted: {len(self.displacement)} readings, up to {largest:.4g} µm, {known}>"

    def _repr_html_(self) -> str:
        """What a notebook shows: the first readings, with their uncertainty where it is known."""
        said, unit, factor = self.displacement, "µm", 1e6
        if self.position is not None:
            said, unit, factor = self.position, "mm", 1e3
        columns = {f"{axis} [{unit}]": factor * said[:, k] for k, axis in enumerate(AXES)}
        if self.std is not None:
            columns |= {f"± {axis}": factor * self.std[:, k] for k, axis in enumerate(AXES)}
        return html_table(repr(self), columns)

    def __post_init__(self) -> None:
        shape = self.displacement.shape
        for part in (self.std_parameters, self.std_remainder):
            if part is not None and part.shape != shape:
                raise ValueError(f"an uncertainty of shape {part.shape} for {shape}")

    @property
    def std(self) -> Array | None:
        """(N, 3) both together [m]; the noise of a reading comes on top of it."""
        if self.std_parameters is None:
            return None
        left = 0.0 if self.std_remainder is None else self.std_remainder
        return np.asarray(np.hypot(self.std_parameters, left))

    def gap(self, measurements: Measurements) -> Array:
        """(N, 3) measured minus predicted, of positions where these were read [m]; NaN: not read.

        Examples:
            >>> import sk120stiff as sk
            >>> data = sk.bundled_robots()["motoman_sk120"] / "data" / "table2_measured.csv"
            >>> readings = sk.read(data)
            >>> said = sk.predict(sk.base_model(sk.load_robot("motoman_sk120")), readings)
            >>> said.gap(readings).shape
            (15, 3)
        """
        read = vectors_read(measurements)
        said = self.displacement if self.position is None else self.position
        return np.full_like(said, np.nan) if read is None else np.asarray(read - said)

    def among(self, held: Mask) -> Predicted:
        """The same readings among others (M,) that have no prediction: NaN there."""

        def placed(x: Array) -> Array:
            full = np.full((len(held), 3), np.nan)
            full[held] = x
            return full

        blame: list[tuple[str, ...]] = [()] * len(held)
        for row, names in zip(np.flatnonzero(held), self.blame, strict=False):
            blame[row] = names
        return Predicted(
            placed(self.displacement),
            None if self.std_parameters is None else placed(self.std_parameters),
            None if self.std_remainder is None else placed(self.std_remainder),
            tuple(blame),
        )


def predict(model: Model, measurements: Measurements) -> Predicted:
    """What a model says of every row of measurements, or of a plan; ± where that is known.

    Of absolute readings it is where the marker stands. What a model says of the zero readings of
    its own file, pose by pose, is nothing of another file, whatever its poses are called.

    Args:
        model: Robot, effects, and their uncertainty if it is known.
        measurements: Rows with poses and loads; masked ones are predicted too, displacements are
            not looked at.

    Raises:
        InputError: The joints are not the robot's, or the model does not know where the instrument
            of these positions stands.
        Refusal: The springs cannot hold a load.

    Warns:
        ToolkitWarning: It is in doubt how warm, or how late, the readings are to the model.

    Examples:
        >>> import sk120stiff as sk
        >>> data = sk.bundled_robots()["motoman_sk120"] / "data" / "table2_measured.csv"
        >>> readings = sk.read(data)
        >>> said = sk.predict(sk.base_model(sk.load_robot("motoman_sk120")), readings)
        >>> gap = said.gap(readings)  # (N, 3) [m]
        >>> print(f"{1e6 * (gap**2).mean() ** 0.5:.1f} µm rms")
        26.4 µm rms
    """
    model, measurements = model.under(measurements.gravity), as_displacements(measurements)
    if measurements.absolute is None:
        return predict_with_uncertainty(model, seen_by(model, measurements))
    refuse_unknown_place(model, measurements)
    warn_of_references(model, measurements)
    return predict_channels(model, measurements)


def seen_by(model: Model, measurements: Measurements) -> LoadCases:
    """The readings as a model sees them: what it says of zero readings is of its own file alone."""
    load_cases = load_cases_of(model.robot, in_the_frame(measurements))
    fitted_to = model.provenance.get("data_hash", "")
    own = fitted_to in ("", f"sha256:{measurements.data_hash}")
    return load_cases if own else load_cases.of_another_file


def knows_place(model: Model, measurements: Measurements) -> bool:
    """Whether the model has a frame for readings in an instrument's own axes, where they are so."""
    said = measurements.absolute
    known = any(isinstance(effect, Viewpoint) for effect in model.effects)
    return known or said is None or said.frame != "unknown"


def refuse_unknown_place(model: Model, measurements: Measurements) -> None:
    """Stop where readings are in an instrument's own axes, and the model has no frame for it.

    Raises:
        InputError: So it is.
    """
    if not knows_place(model, measurements):
        raise InputError(
            "the model does not know where the tracker stands",
            where=measurements.place,
            remedy="Give a model that was fitted to readings of this tracker, as 'identify' and "
            "'explain' write it.",
        )


def predict_channels(model: Model, measurements: Measurements) -> Predicted:
    """Where each marker stands as the instrument sees it, or how far a load moves it; ± if known.

    Raises:
        Refusal: The springs cannot hold the arm's weight or a load.
    """
    load_cases = load_cases_of(model.robot, measurements)
    known, said = model.uncertainty, measurements.absolute
    if said is not None and said.channels.displacement is not None:
        went = move_by_load(model, load_cases, derivative=known is not None)
        turn = None if said.channels.turn is None else rotation_vector(went.rotation)
        if known is None:
            return Predicted(went.displacement, turn=turn)
        std, blame = _spread_of(known, model.names, went.columns[:, :3])
        left = remainder_std(known, load_cases)
        return Predicted(went.displacement, std, left, blame, turn=turn)
    seen = read_poses(model, load_cases, derivative=known is not None)
    moved = model.predict(load_cases)
    level, down = None if said is None else said.channels.level, model.robot.gravity_in_base
    leans = None
    if level is not None and down.any():
        leans = inclined(level, seen.standing, seen.turning, down / np.linalg.norm(down))[0]
    if known is None:
        return Predicted(moved, None, None, (), seen.position, seen.rotation, None, leans)
    std, blame = _spread_of(known, model.names, seen.columns[:, :3])
    left = remainder_std(known, load_cases)
    return Predicted(moved, std, left, blame, seen.position, seen.rotation, None, leans)


def predict_with_uncertainty(model: Model, load_cases: LoadCases) -> Predicted:
    """Predicted readings ± what the parameters and what the model lacks make of them.

    To first order in the parameters, by the exact derivative at equilibrium: deflections are linear
    in compliances but for what the load's own stiffness K_C adds.

    Args:
        model: Robot, effects, and their uncertainty if it is known.
        load_cases: The N readings.

    Raises:
        Refusal: The springs cannot hold a load.
    """
    known = model.uncertainty
    if known is None:
        return Predicted(model.predict(load_cases))
    displacement, derivative = model.predict_with_sensitivities(load_cases)
    std, blame = _spread_of(known, model.names, derivative)
    return Predicted(displacement, std, remainder_std(known, load_cases), blame)


def _spread_of(
    known: Uncertainty, names: tuple[str, ...], derivative: Array
) -> tuple[Array, tuple[tuple[str, ...], ...]]:
    """(N, 3) standard uncertainty of what has a derivative (N, 3, P), and whom it is unknown by."""
    L, B = known.factors(names)
    std = spread(derivative @ L, derivative @ B, known.floor)
    lost = np.atleast_1d(np.isinf(std).any(axis=1))
    return std, tuple(
        blamed(known, names, own) if out else () for own, out in zip(derivative, lost, strict=True)
    )


def remainder_std(known: Uncertainty, load_cases: LoadCases) -> Array | None:
    """(N, 3) standard size of what is unexplained, axes of the readings [m]; None: not known."""
    if known.remainder is None:
        return None
    of_base = known.remainder.std(load_cases.wrench)
    return np.asarray(np.sqrt(np.einsum("nij,ni->nj", load_cases.reading_axes**2, of_base**2)))


def blamed(known: Uncertainty, names: tuple[str, ...], derivative: Array) -> tuple[str, ...]:
    """Parameters whose unseen changes move quantities with this derivative (..., P) most."""
    _, B = known.factors(names)
    share = (derivative.reshape(-1, len(names), 1) * B) ** 2  # (k, P, b)
    size = share.sum(axis=(0, 2))
    return tuple(
        name for name, own in zip(names, size, strict=True) if own > HIDDEN * size.max(initial=0.0)
    )


UNHELD = "no static equilibrium: the springs cannot hold this load"


def predict_what_holds(model: Model, load_cases: LoadCases) -> Predicted:
    """Predictions ± uncertainty; NaN, with a warning, where no equilibrium exists.

    Raises:
        Refusal: None of the loads can be held.
    """
    try:
        return predict_with_uncertainty(model, load_cases)
    except Refusal:
        held = held_loads(model, load_cases)
        if not held.any():
            raise
    warn(
        f"{int((~held).sum())} of {len(held)} loads are beyond what the springs can hold; their "
        "rows are left empty and say so."
    )
    return predict_with_uncertainty(model, load_cases.rows(held)).among(held)


Columns = dict[str, list[object]]


def rows_of(columns: Mapping[str, Iterable[object]]) -> list[dict[str, object]]:
    """The rows of a table, each a mapping from header to cell."""
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def prediction_table(readings: Measurements, predicted: Predicted) -> Columns:
    """One row per reading: pose, prediction ± its uncertainty, measurement and gap if any [mm, µm].

    Header → cells.

    A column `reason` says why a prediction is missing, `std_reason` why an uncertainty is unknown,
    if any is.
    """
    columns: dict[str, object] = {"pose": list(readings.pose)}
    of = "d" if predicted.position is None else ""
    said = predicted.displacement if predicted.position is None else predicted.position
    for k, axis in enumerate(AXES):
        columns[f"predicted_{of}{axis}[mm]"] = said[:, k] * 1e3
    for name, std in (
        ("parameters", predicted.std_parameters),
        ("remainder", predicted.std_remainder),
    ):
        if std is not None:
            told = np.where(np.isfinite(std), std, np.nan) * 1e6
            columns |= {f"std_{name}_{axis}[um]": told[:, k] for k, axis in enumerate(AXES)}
    read = vectors_read(readings)
    if read is not None:
        for k, axis in enumerate(AXES):
            columns[f"{of}{axis}[mm]"] = read[:, k] * 1e3
        for k, axis in enumerate(AXES):
            columns[f"gap_{axis}[um]"] = (read - said)[:, k] * 1e6
    columns |= of_turns(readings, predicted.turn, predicted.rotation)
    columns |= of_gauges(readings, predicted.displacement)
    columns |= of_wires_and_levels(readings, predicted.position, predicted.inclination)
    columns["use"] = readings.use.astype(int)
    missing = ~np.isfinite(predicted.displacement).all(axis=1)
    if missing.any():
        columns["reason"] = np.where(missing, UNHELD, "")
    reasons = unknown_reasons(predicted)
    if any(reasons):
        columns["std_reason"] = reasons
    return {name: np.asarray(cells, dtype=object).tolist() for name, cells in columns.items()}


def unknown_reasons(predicted: Predicted) -> list[str]:
    """Why the uncertainty of each row is unknown; empty where it is known."""
    return [blame_reason(names) for names in predicted.blame]


def blame_reason(names: tuple[str, ...]) -> str:
    """Why a ± is unknown; empty if it is not."""
    if not names:
        return ""
    return f"depends on {', '.join(names)}, of which the readings of the fit do not show enough"
