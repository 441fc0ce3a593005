"""Payloads and places on the tool that no arm has: grams for kilograms, millimetres for metres."""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.measurements.data import Measurements
from sk120stiff.robot import Robot
from sk120stiff.robot.anatomy import arm_length

TIMES = 3.0  # own weights that no arm carries
CARRIED = 1.0  # own weights that the strongest carry; more than that is told
PER_AREA = 500.0  # kg per squared metre of reach that no arm carries, where masses are unknown
LIGHT = 25.0  # the same, below which a URDF that weighs little may leave most masses out
NOTHING = 1e-3  # share of its own weight that does not bend an arm so that it shows
CLOSE = 1e-3  # m; nothing is fixed to a tool so near to the origin of its frame, but at it


def doubtful_sizes(robot: Robot, readings: Measurements) -> tuple[str, ...]:
    """What is stated of payload and markers and looks a thousand times too small, in sentences.

    Raises:
        InputError: It is so large that it must be a slip of its unit.
    """
    said = readings.absolute
    if said is None:
        return ()
    rows = np.flatnonzero(readings.use)
    told = [
        *_place("the marker", "point", said.point[rows], robot, readings),
        *_place("the payload", "payload.point", said.payload_point[None], robot, readings),
    ]
    heaviest = float(np.abs(said.payload[rows]).max(initial=0.0))
    reach, own = arm_length(robot), robot.total_mass
    most = max(TIMES * own, LIGHT * reach**2) if own > 0.0 else PER_AREA * reach**2
    if heaviest > most:
        row = int(rows[np.argmax(np.abs(said.payload[rows]))])
        against = f"weighs {own:.4g} kg itself" if own > 0.0 else f"reaches {reach:.3g} m"
        raise InputError(
            f"a payload of {heaviest:.4g} kg on an arm that {against}: it looks 1000 times too "
            "large, as if in grams",
            where=f"{readings.path or 'measurements'}, line {readings.line[row]}, column payload",
            remedy="Write the masses in kg under payload[kg].",
        )
    if 0.0 < heaviest < NOTHING * own:
        told.append(
            f"The heaviest payload is {heaviest:.3g} kg on an arm of {own:.3g} kg: it bends "
            "nothing. Are they tonnes, or kg under a header in g?"
        )
    told += heavier_than_the_arm(heaviest, own)
    return tuple(told)


def heavier_than_the_arm(heaviest: float, own: float, what: str = "is") -> list[str]:
    """That a payload [kg] is more than an arm of `own` [kg] carries, where it is."""
    if own == 0.0 or heaviest <= CARRIED * own:
        return []
    return [
        f"The heaviest payload {what} {heaviest:.3g} kg on an arm that weighs {own:.3g} kg itself: "
        "no arm carries more than its own weight. Check that the column payload is in kg and is "
        "the mass on the tool, and that the URDF states the mass of every link."
    ]


def _place(what: str, key: str, place: Array, robot: Robot, readings: Measurements) -> list[str]:
    away = np.linalg.norm(place, axis=1)
    far, reach = float(away.max(initial=0.0)), arm_length(robot)
    if far > max(reach, 1.0):
        raise InputError(
            f"{what} is stated {far:.4g} m from the tool frame of an arm that reaches "
            f"{reach:.3g} m: it looks 1000 times too large",
            where=f"{readings.path or 'measurements'}, its YAML file, {key}",
            remedy="Millimetres are written with 'unit: mm'.",
        )
    near = away[away > 0.0]
    if len(near) and near.min() < CLOSE:
        return [
            f"{what.capitalize()} is stated {1e3 * near.min():.3g} mm from the tool frame's "
            f"origin: metres under 'unit: mm' of {key}?"
        ]
    return []
