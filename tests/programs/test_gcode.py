"""G-code: arcs against closed forms, modal words, and lines that stop it."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sk120stiff.errors import InputError
from sk120stiff.programs import read_gcode
from sk120stiff.programs.toolpath import arc_points

CHORD = 1e-5


def read(folder: Path, text: str, chord: float = CHORD, step: float = np.inf):
    file = folder / "path.nc"
    file.write_text(text)
    return read_gcode(file, chord=chord, step=step)


def test_words_hold_until_they_are_changed(tmp_path: Path) -> None:
    path = read(
        tmp_path,
        "%\nO7 (part)\nN1 G21 G90 G17 G54 ; metric\nG0 Z5.\nG0 X1 Y2\ng1 z-1 f60\nX11\n"
        "G91 Y-2.5\nG90 G20 X1 F10\n/ G0 Z1 (up)\nM30\n",
    )
    expected = [[1, 2, 5], [1, 2, -1], [11, 2, -1], [11, -0.5, -1], [25.4, -0.5, -1],
                [25.4, -0.5, 25.4]]  # fmt: skip
    np.testing.assert_allclose(1e3 * path.position, expected, atol=1e-12)
    np.testing.assert_allclose(path.feed[1:], [1e-3, 1e-3, 1e-3, 0.254 / 60, 0.254 / 60])
    assert np.isnan(path.feed[0])  # nobody has said it yet
    assert path.rapid.tolist() == [True, False, False, False, False, True]
    assert path.lines.tolist() == [5, 6, 7, 8, 9, 10]
    assert path.left_out == {"the mark of block skip": 10, "M30": 11}


@pytest.mark.parametrize("plane", ["G17", "G18", "G19"])
@pytest.mark.parametrize("way", ["G2", "G3"])
def test_an_arc_lies_on_its_circle_and_turns_the_right_way(
    tmp_path: Path, plane: str, way: str
) -> None:
    """A quarter from the first to the second axis of the plane is G3, three quarters the other."""
    first, second = {"G17": "XY", "G18": "ZX", "G19": "YZ"}[plane]
    offset = {"X": "I", "Y": "J", "Z": "K"}[first]
    path = read(
        tmp_path, f"G0 X0 Y0 Z0\n{first}30\n{plane} {way} {first}0 {second}30 {offset}-30 F100\n"
    )
    a, b = ["XYZ".index(axis) for axis in (first, second)]
    points = path.position[1:]
    x, y = points[:, a], points[:, b]
    np.testing.assert_allclose(np.hypot(x, y), 0.03, atol=1e-12)
    middle = [points[:-1, k] + 0.5 * np.diff(points[:, k]) for k in (a, b)]
    off = 0.03 - np.hypot(*middle)
    assert 0.8 * CHORD < off.max() <= CHORD * (1 + 1e-9)  # as coarse as allowed, no coarser
    turned = np.unwrap(np.arctan2(y, x))
    assert turned[-1] == pytest.approx(np.pi / 2 if way == "G3" else -1.5 * np.pi)
    assert (np.diff(turned) * turned[-1] > 0.0).all()
    assert not path.position[:, 3 - a - b].any()


def test_centres_radii_and_whole_circles_are_one_thing(tmp_path: Path) -> None:
    begin = "G0 X10 Y0 Z0\n"
    by_centre = read(tmp_path, f"{begin}G3 X0 Y10 I-10 J0 F9\n").position
    for same in ("G3 X0 Y10 R10 F9", "G90.1 G3 X0 Y10 I0 J0 F9", "G91 G3 X-10 Y10 R10 F9"):
        np.testing.assert_allclose(read(tmp_path, begin + same).position, by_centre, atol=1e-15)
    long_way = read(tmp_path, f"{begin}G3 X0 Y10 R-10 F9\n").position
    np.testing.assert_allclose(  # the other centre: three quarters about (10, 10)
        np.linalg.norm(long_way[:, :2] - [0.01, 0.01], axis=1), 0.01, atol=1e-12
    )
    whole = read(tmp_path, f"{begin}G2 I-10 F9\n").position
    angle = np.unwrap(np.arctan2(whole[:, 1], whole[:, 0]))
    assert angle[-1] == pytest.approx(-2 * np.pi)
    helix = read(tmp_path, f"{begin}G3 X10 Y0 Z6 I-10 P3 F9\n").position
    angle = np.unwrap(np.arctan2(helix[:, 1], helix[:, 0]))
    np.testing.assert_allclose(helix[:, 2], 0.006 * angle / (6 * np.pi), atol=1e-12)


@given(
    radius=st.floats(1e-3, 2.0),
    sweep=st.floats(0.01, 2 * np.pi - 0.01),
    chord=st.floats(1e-6, 1e-3),
    seed=st.integers(0, 99),
)
@settings(max_examples=60, deadline=None)
def test_any_arc_in_space_against_the_closed_form(
    radius: float, sweep: float, chord: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    n, u = np.linalg.qr(rng.normal(size=(3, 2)))[0].T
    v, centre = np.cross(n, u), rng.normal(size=3)
    rise = rng.normal() * n

    def at(angle: np.ndarray) -> np.ndarray:
        angle = np.atleast_1d(angle)[:, None]
        return centre + radius * (np.cos(angle) * u + np.sin(angle) * v) + angle / sweep * rise

    found = arc_points(at(0.0)[0], at(sweep)[0], centre, n, turns=1, chord=chord, most=10**6)
    count = len(found)
    np.testing.assert_allclose(found, at(sweep * np.arange(1, count + 1) / count), atol=1e-9)
    assert radius * (1 - np.cos(sweep / count / 2)) <= chord * (1 + 1e-6)
    if count > 2:
        assert radius * (1 - np.cos(sweep / (count - 1) / 2)) > chord * (1 - 1e-6) or (
            sweep / (count - 1) > np.pi / 2
        )


def test_long_feed_moves_are_divided(tmp_path: Path) -> None:
    text = "G0 X0 Y0 Z0\nG0 X100\nG1 Y25 F9\n"
    path = read(tmp_path, text, step=0.01)
    np.testing.assert_allclose(1e3 * path.position[:, 1], [0, 0, 25 / 3, 50 / 3, 25])
    assert len(read(tmp_path, text).position) == 3


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("G0 X0 Y0 Z0\nG81 X1 R2 Z-3\n", "line 2: G81 is not followed"),
        ("G0 X0 Y0 Z0\nG41 X1\n", "G41"),
        ("G0 X0 Y0 Z0\nG92 X1\n", "G92"),
        ("G0 X0 Y0 Z0\nG53 X1\n", "G53"),
        ("G0 X0 Y0 Z0\nG1 X[1+2]\n", "variables"),
        ("G0 X0 Y0 Z0\nG1 X#3\n", "variables"),
        ("G0 X0 Y0 Z0\nG1 X1 A30 F1\n", "axis A"),
        ("G0 X0 Y0 Z0\nG1 X1 X2\n", "stands twice"),
        ("G0 X0 Y0 Z0\nG0 G1 X1\n", "two kinds of motion"),
        ("G0 X0 Y0 Z0\nG1 X1 F0\n", "feed of 0"),
        ("G0 X0 Y0 Z0\nG1 (X1\n", "not closed"),
        ("G0 X0 Y0 Z0\nX1 ?\n", "no word of G-code"),
        ("G0 X0\nG1 Y3 F9\n", "line 2: the tool feeds before"),
        ("G91 G0 X1\n", "not known"),
        ("X1\n", "no G0, G1"),
        ("G0 X0 Y0 Z0\nG2 X1 F9\n", "neither a centre"),
        ("G0 X0 Y0 Z0\nG2 X1 I1 R1 F9\n", "both"),
        ("G0 X0 Y0 Z0\nG2 X10 R1 F9\n", "does not span"),
        ("G0 X0 Y0 Z0\nG2 R1 F9\n", "whole circle by R"),
        ("G0 X0 Y0 Z0\nG2 X10 I4 F9\n", "from its centre"),
        ("G0 X0 Y0 Z0\nG2 X10 K4 F9\n", "across the plane"),
        ("G0 X0 Y0 Z0\nG1 X1 I4 F9\n", "belong to arcs"),
        ("G54 G0 X0 Y0 Z0\nG55 X1\n", "second part frame"),
        ("M98 P10\n", "another program"),
        ("G0 X1" + "0" * 30 + "Y0 Z0\n", "from the origin"),
        ("G0 X0 Y0 Z0\nG2 X1 I9999999999 F9\n", "from the origin"),
        ("G0 X0 Y0 Z0\nG1 X1 F1" + "0" * 30, "a feed of"),
        ("(nothing)\nM3 S100\n", "moves nothing"),
        ("", "moves nothing"),
    ],
)
def test_what_is_not_understood_stops_with_its_line(tmp_path: Path, text: str, says: str) -> None:
    with pytest.raises(InputError) as told:
        read(tmp_path, text)
    assert says in str(told.value)


def test_an_endless_arc_is_refused_before_it_is_made(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="more than 500000 points"):
        read(tmp_path, "G0 X1000 Y0 Z0\nG2 X1000 I-1000 P9999 F9\n", chord=1e-9)


def test_a_step_of_nothing_is_refused_before_it_is_made(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="line 2: the path has more than 500000 points"):
        read(tmp_path, "G0 X0 Y0 Z0\nG1 X100 F9\n", step=1e-18)


def test_a_unit_that_is_not_stated_is_told(tmp_path: Path) -> None:
    assert read(tmp_path, "G90\nG21 G1 X1 Y0 Z0 F60\nX2\n").assumed == ()
    (told,) = read(tmp_path, "G90\nG1 X1 Y0 Z0\nX2\nG21\n").assumed
    assert "millimetres" in told and "line 2" in told


@pytest.mark.parametrize("line", ["G1 X1O0", "X1 N3", "G1 O7"])
def test_a_letter_within_a_number_does_not_shorten_a_move(tmp_path: Path, line: str) -> None:
    with pytest.raises(InputError, match=r"line 2: .* stands behind other words"):
        read(tmp_path, f"N1 G21 G90 G1 X0 Y0 Z0\n{line}\n")
