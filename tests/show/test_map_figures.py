"""Slices of a map go through the point they should, name units, and leave out what is unstable."""

import numpy as np
import pytest

from sk120stiff.errors import InputError
from sk120stiff.show import figures_of_map
from sk120stiff.show.figures import stiffness_slice

xarray = pytest.importorskip("xarray")

X, Y, Z = np.radians([-40.0, 0.0, 50.0]), np.array([0.1, 0.3]), np.radians([10.0, 20.0, 30.0, 40.0])
SOFTEST = {"elbow": X[2], "slide": Y[0], "wrist": Z[3]}


def made(least: np.ndarray) -> "xarray.Dataset":
    """A map over two turning joints and a sliding one under one load."""
    dims = ("load", "elbow", "slide", "wrist")
    classes = np.where(least > 0.0, 0, 4).astype(np.uint8)
    classes[np.isnan(least)] = 255
    return xarray.Dataset(
        {
            "minimum_stiffness": (dims, least),
            "stability": (dims, classes),
            "K_C_definiteness": (dims, np.full(least.shape, 4, dtype=np.uint8)),
            "wrench": (("load", "component"), np.array([[0, 0, -490.0, 0, 0, 0]])),
        },
        {
            "elbow": ("elbow", X, {"units": "rad"}),
            "slide": ("slide", Y, {"units": "m"}),
            "wrist": ("wrist", Z, {"units": "rad"}),
        },
    )


def values() -> np.ndarray:
    least = np.linspace(1e6, 3e6, 24).reshape(1, 3, 2, 4)
    least[0, 2, 0, 3] = 5e5
    return least


def test_every_pair_of_axes_has_its_two_figures_with_units() -> None:
    found = {each.name: each.figure for each in figures_of_map(made(values()))}
    pairs = ["elbow_slide", "elbow_wrist", "slide_wrist"]
    kinds = ["stiffness", "definiteness"]
    assert sorted(found) == sorted(f"load1_{pair}_{kind}" for pair in pairs for kind in kinds)
    axes = found["load1_elbow_slide_stiffness"].axes
    assert (axes[0].get_xlabel(), axes[0].get_ylabel()) == ("elbow [deg]", "slide [mm]")
    assert axes[1].get_ylabel() == "least stiffness [N/µm]"
    assert axes[0].get_xlim() == pytest.approx((-40.0, 50.0))
    assert axes[0].get_ylim() == pytest.approx((100.0, 300.0))
    assert "wrist = 40.0°" in axes[0].get_title(loc="left")
    assert "-490 N" in axes[0].get_title(loc="left")


def test_the_mark_stands_at_the_softest_point() -> None:
    found = {each.name: each.figure for each in figures_of_map(made(values()))}
    (mark,) = found["load1_elbow_wrist_stiffness"].axes[0].lines
    assert mark.get_xydata()[0] == pytest.approx((50.0, 40.0))


def test_what_is_unstable_stays_white_and_is_said() -> None:
    least = values()
    least[0, 2, 0, 3] = -2e6
    least[0, 0, 0, 0] = np.nan
    found = {each.name: each.figure for each in figures_of_map(made(least))}
    panel = found["load1_elbow_wrist_stiffness"].axes[0]
    assert "unstable" in panel.get_title(loc="left")
    assert not panel.lines  # the softest is among what is left out
    low, _ = found["load1_elbow_wrist_stiffness"].axes[1].get_ylim()
    assert low >= 1.0


def test_bad_questions_are_refused() -> None:
    with pytest.raises(InputError, match="no load 1"):
        figures_of_map(made(values()), load=1)
    with pytest.raises(InputError, match="two axes"):
        figures_of_map(made(values()).isel(slide=[0], wrist=[0]))
    with pytest.raises(InputError, match="no point"):
        figures_of_map(made(np.full((1, 3, 2, 4), np.nan)))


def test_what_lies_beyond_the_scale_is_marked_and_told() -> None:
    x, y = np.linspace(0.4, 1.2, 9), np.linspace(0.0, 0.8, 8)
    bent = np.linspace(2e-4, 2.4e-3, 72).reshape(8, 9)
    asked = {"x_label": "x", "y_label": "z", "units": ("mm", "mm"), "scale": 1e6}
    even = stiffness_slice(x, y, np.full((8, 9), 1e-3), value_label="deflection [µm]", **asked)
    assert even.axes[1].get_ylabel() == "deflection [µm]"
    bent[-1, -1] = 2.7773e-3
    figure = stiffness_slice(x, y, bent, value_label="deflection [µm]", **asked)
    figure.canvas.draw()
    bar = figure.axes[1]
    assert bar.get_ylabel() == "deflection [µm]; top 2 %: to 2777"
    drawn = figure.axes[0].collections[0]
    assert drawn.extend == "max"
    beyond, end = (np.array(drawn.cmap(value)[:3]) for value in (1.5, 1.0))
    assert np.abs(beyond - end).max() > 0.1
    told = [text.get_text() for text in (*bar.get_yticklabels(), *figure.axes[0].texts)]
    assert any(len(text) == 4 and text.isdigit() for text in told)
    assert not any("e+" in text for text in told)
