"""Positions, single readings and turns made from a model: each row as the plan has it, with noise.

Nothing is subtracted and no zero reading is taken: the instrument reads where things stand, or what
a load did to them, and every number has an error of its own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array, Mask
from sk120stiff.effects import load_cases_of
from sk120stiff.identify.positions.solve.pose_problem import absolute_of
from sk120stiff.measurements import Channels, Measurements
from sk120stiff.measurements.channels import ANGLES, BY_LOAD, KINDS, Kind, inclined
from sk120stiff.model import Model
from sk120stiff.model.pose_reading import move_by_load, read_poses
from sk120stiff.model.predicted import knows_place, refuse_unknown_place
from sk120stiff.robot.rotations import rotation_of, rotation_vector


def simulated_channels(
    model: Model,
    plan: Measurements,
    *,
    length: float,
    angle: float,
    own_zero: bool,
    off: Mask,
    size: Array,
    rng: np.random.Generator,
) -> Measurements:
    """The rows of a plan of channels with what a modelled arm would give.

    Cells that hold a reading are replaced; of a plan all cells that its columns have.

    Args:
        length, angle: Standard uncertainty of one reading [m and rad].
        own_zero: What a load does is the difference of two of them.
        off, size: (N,) rows that are outliers, and by how many times their noise [1].

    Raises:
        InputError: The model does not know where the instrument stands.
        Refusal: The springs cannot hold the arm's weight or a load.
    """
    said = absolute_of(plan)
    model = model.under(plan.gravity)
    notes: tuple[str, ...] = ()
    if plan.is_plan and not knows_place(model, plan):  # nobody has put it anywhere yet
        notes = ("The instrument's axes are those of the base: the model knows of no others.",)
    else:
        refuse_unknown_place(model, plan)
    exact = foretold(model, plan, said.channels)
    twice = np.sqrt(2.0) if own_zero else 1.0
    sigma = {
        kind: (angle if kind in ANGLES else length) * (twice if kind in BY_LOAD else 1.0)
        for kind in KINDS
    }
    made = dict[str, Array]()
    for kind, values in exact.items():
        made[kind] = _read(kind, values, sigma[kind], off, size, rng)
        if said.channels.present:  # readings to be replaced, and no plan
            made[kind][~np.isfinite(getattr(said.channels, kind))] = np.nan
    stated: dict[str, float] = {kind: value for kind, value in sigma.items() if value > 0.0}
    channels = replace(said.channels, **made, sigma=stated, sigma_of_rows=None, rays=None)
    return replace(
        plan, absolute=replace(said, channels=channels), path=None, data_hash="", notes=notes
    )


def foretold(model: Model, plan: Measurements, channels: Channels) -> Mapping[Kind, Array]:
    """What every kind of channel would read without noise, all N rows of it."""
    load_cases = load_cases_of(model.robot, plan)
    seen = read_poses(model, load_cases)
    out: dict[Kind, Array] = {}
    if channels.position is not None:
        out["position"] = seen.position
    if channels.rotation is not None:
        out["rotation"] = seen.rotation
    if channels.distance is not None and channels.anchor is not None:
        out["distance"] = np.linalg.norm(seen.position - channels.anchor, axis=1)
    if channels.inclination is not None and channels.level is not None:
        down = model.robot.gravity_in_base
        down = down / (float(np.linalg.norm(down)) or 1.0)
        out["inclination"] = inclined(channels.level, seen.standing, seen.turning, down)[0]
    if channels.by_load:
        moved = move_by_load(model, load_cases)
        if channels.shift is not None and channels.along is not None:
            out["shift"] = np.einsum("ni,ni->n", channels.along, moved.displacement)
        if channels.displacement is not None:
            out["displacement"] = moved.displacement
        if channels.turn is not None:
            out["turn"] = rotation_vector(moved.rotation)
    return out


def _read(
    kind: str, exact: Array, sigma: float, off: Mask, size: Array, rng: np.random.Generator
) -> Array:
    """With noise, and with outliers in a random direction."""
    width = 3 if kind == "rotation" else exact.shape[1] if exact.ndim == 2 else 1
    draws = rng.normal(size=(len(exact), width))
    way = rng.normal(size=draws.shape)
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    error = sigma * (draws + (off * size)[:, None] * way)
    if kind == "rotation":
        return np.asarray(rotation_of(error) @ exact)
    return np.asarray(exact + error.reshape(exact.shape))
