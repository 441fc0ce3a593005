"""The picture of a gear: its band lies about the whole curve, and what is left out is told."""

import numpy as np
import pytest
from matplotlib.collections import PolyCollection
from matplotlib.path import Path

from sk120stiff.explain.judge.gear_curve import STEPS, GearCurve
from sk120stiff.show.figures.gear_curve import gear_curve, left_out, ways
from sk120stiff.show.stories.sizes_sections import _picture

UP = np.linspace(0.0, 1.0, STEPS)
BENCH = 1000.0 * np.concatenate([UP, UP[-2::-1], -UP[1:], -UP[-2::-1], UP[1:]])
COMPLIANCE = 5e-7


def curve(loop: float = 0.0, measured: np.ndarray | None = None) -> GearCurve:
    """Play of 1e-4 rad with soft flanks; a loop of this half width [rad] beside it."""
    falls = np.diff(BENCH, prepend=-1.0) < 0.0
    gone = np.arange(len(BENCH)) >= STEPS
    twist = COMPLIANCE * BENCH + 1e-4 * np.tanh(BENCH / 50.0) + loop * np.where(falls, 1, -1) * gone
    return GearCurve(
        where="j3", names=("lost_motion:j3",), torque=BENCH, twist=twist, compliance=COMPLIANCE,
        band=np.full(len(BENCH), 2e-5), ideal=COMPLIANCE * BENCH,
        measured=np.zeros((0, 2)) if measured is None else measured,
    )  # fmt: skip


def bands(panel: object) -> list[Path]:
    drawn = [each for each in panel.collections if isinstance(each, PolyCollection)]  # type: ignore[attr-defined]
    return [path for each in drawn for path in each.get_paths()]


@pytest.mark.parametrize("loop", [0.0, 6e-5])
@pytest.mark.parametrize("panel", [0, 1])
def test_the_band_lies_about_the_whole_curve(loop: float, panel: int) -> None:
    gear = curve(loop)
    polygons = bands(gear_curve(gear).axes[panel])
    straight = COMPLIANCE * BENCH if panel else 0.0
    found = 1e6 * (gear.twist - straight)
    inner = np.abs(BENCH) < 999.0  # on the end itself in or out is rounding

    def covered(y: np.ndarray) -> np.ndarray:
        points = np.stack([BENCH, y], axis=1)
        return np.any([path.contains_points(points) for path in polygons], axis=0)

    for shift in (-18.0, 0.0, 18.0):
        assert covered(found + shift)[inner].all()
    if not loop:
        for shift in (-22.0, 22.0):
            assert not covered(found + shift)[inner].any()


def test_a_way_that_was_gone_before_is_filled_once() -> None:
    assert len(ways(curve())) == 1
    assert len(ways(curve(loop=6e-5))) == 3


def test_readings_outside_are_counted_and_told() -> None:
    far = np.array([[500.0, 3e-4], [500.0, 9e-3], [-500.0, -8e-3]])
    gear = curve(measured=far)
    assert left_out(gear, 0.0) == 2
    assert "2 of 3 readings lie outside" in gear_curve(gear).axes[0].get_title(loc="left")
    assert "2 of 3 readings lie outside what is drawn" in _picture(gear).caption
    assert "outside" not in _picture(curve()).caption
    assert "outside" not in gear_curve(curve()).axes[0].get_title(loc="left")
