"""Which turn of the tool about its own axis a path takes."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.errors import Refusal
from sk120stiff.programs.bad_targets import least_turn

SMOOTH = np.zeros((3, 6))
BACK = SMOOTH + np.array([0.0, 3.5, 0.0])[:, None]


@pytest.mark.parametrize(
    ("joints", "degrees"),
    [
        ({0: SMOOTH, 180: SMOOTH}, 0),
        ({180: BACK, 90: SMOOTH}, 90),
        ({0: BACK, 180: BACK}, 0),
        ({-90: BACK}, -90),
    ],
)
def test_the_first_turn_that_passes_no_limit_is_taken(joints: dict, degrees: int) -> None:
    robot = sk.load_robot("motoman_sk120")

    def find(path: SimpleNamespace) -> np.ndarray:
        if path.turn not in joints:
            raise Refusal(f"not at {path.turn}")
        return joints[path.turn]

    def turned(angle: float) -> SimpleNamespace:
        return SimpleNamespace(turn=round(np.degrees(angle)))

    turn, path, a = least_turn(robot, turned, find)
    assert turn == path.turn == degrees and a is joints[degrees]


def test_a_path_that_no_turn_reaches_is_refused_as_at_the_first() -> None:
    robot = sk.load_robot("motoman_sk120")

    def find(angle: float) -> np.ndarray:
        raise Refusal(f"not at {angle:.0f}")

    with pytest.raises(Refusal, match="not at 0"):
        least_turn(robot, lambda angle: angle, find)
