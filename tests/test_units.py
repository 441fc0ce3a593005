"""Units against hand arithmetic, and the messages for what cannot be read."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sk120stiff.errors import InputError
from sk120stiff.units import (
    KINDS,
    from_si,
    is_kind,
    is_unit,
    parse_pose,
    parse_size,
    parse_values,
    parse_wrench,
    split_header,
    to_si,
)

# One of the unit, in SI, by hand.
ONE = [
    ("deg", "angle", math.pi / 180), ("°", "angle", math.pi / 180), ("rad", "angle", 1.0),
    ("mrad", "angle", 1e-3), ("urad", "angle", 1e-6), ("µrad", "angle", 1e-6),
    ("μrad", "angle", 1e-6), ("arcsec", "angle", math.pi / 648000),
    ("degrees", "angle", math.pi / 180),
    ("Grad", "angle", math.pi / 180),  # German; giga-radians are nobody's
    ("mm", "length", 1e-3), ("um", "length", 1e-6), ("µm", "length", 1e-6), ("μm", "length", 1e-6),
    ("m", "length", 1.0), ("cm", "length", 1e-2), ("nm", "length", 1e-9), ("in", "length", 0.0254),
    ("ft", "length", 0.3048), ("micron", "length", 1e-6),
    ("N", "force", 1.0), ("kN", "force", 1e3), ("mN", "force", 1e-3),
    ("lbf", "force", 4.4482216152605),
    ("kgf", "force", 9.80665), ("kp", "force", 9.80665), ("daN", "force", 10.0),
    ("N*m", "moment", 1.0), ("N·m", "moment", 1.0), ("N m", "moment", 1.0), ("Nm", "moment", 1.0),
    ("N-m", "moment", 1.0), ("kNm", "moment", 1e3), ("N*mm", "moment", 1e-3),
    ("Nmm", "moment", 1e-3),
    ("Ncm", "moment", 1e-2), ("lbf*in", "moment", 4.4482216152605 * 0.0254),
    ("s", "time", 1.0), ("ms", "time", 1e-3), ("min", "time", 60.0), ("h", "time", 3600.0),
    ("N*m/rad", "stiffness", 1.0), ("Nmm/rad", "stiffness", 1e-3), ("N/um", "stiffness", 1e6),
    ("N/mm", "stiffness_linear", 1e3), ("Nm/deg", "stiffness_angular", 180 / math.pi),
    ("rad/(N*m)", "compliance", 1.0), ("rad/Nm", "compliance_angular", 1.0),
    ("um/N", "compliance", 1e-6), ("1", "dimensionless", 1.0), ("%", "dimensionless", 0.01),
    ("ppm", "dimensionless", 1e-6), ("kN*mm^2", "N*m**2", 1e-3), ("N·m²", "N*m**2", 1.0),
    ("1/kN", "1/N", 1e-3), ("um/s", "m/s", 1e-6),
]  # fmt: skip


@pytest.mark.parametrize(("unit", "kind", "one"), ONE)
def test_one_of_each_unit(unit: str, kind: str, one: float) -> None:
    assert float(to_si(1.0, unit, kind)) == pytest.approx(one, rel=1e-14)
    assert float(from_si(one, unit, kind)) == pytest.approx(1.0, rel=1e-14)
    assert is_kind(unit, kind)
    assert is_unit(unit)


def test_every_kind_converts_its_usual_units_and_shows_them() -> None:
    for kind, (_, usual) in KINDS.items():
        for unit in usual:
            assert np.isfinite(to_si(1.0, unit, kind))
        with pytest.raises(InputError) as caught:
            to_si(1.0, "parsec", kind)
        assert usual[0] in str(caught.value)
        assert "parsec" in str(caught.value)


def test_millimetres_are_the_nearest_float() -> None:
    values = np.arange(1.0, 20000.0)
    exact = np.array([float(f"{v:.0f}e-3") for v in values])
    assert np.array_equal(to_si(values, "mm", "length"), exact)


@pytest.mark.parametrize(
    ("unit", "kind"),
    [
        ("nm", "moment"),
        ("N", "moment"),
        ("N*m/rad", "moment"),
        ("1", "angle"),
        ("mm", "angle"),
        ("rad", "dimensionless"),
        ("deg", "length"),
        ("s", "length"),
        ("N*m", "stiffness"),
        ("kg", "force"),
        ("KN", "force"),
        ("", "length"),
        ("  ", "length"),
        (None, "length"),
        ("100 m", "length"),
        ("m/0", "length"),
        ("m**m", "length"),
        ("(m", "length"),
        ("mm2", "length"),
        ("9**9**9**9", "dimensionless"),
        ("m**99999", "length"),
        ("__import__('os')", "length"),
    ],
)
def test_what_is_no_such_unit_is_refused(unit: str | None, kind: str) -> None:
    with pytest.raises(InputError) as caught:
        to_si(1.0, unit, kind, where="file.csv, line 1, column dx")
    assert caught.value.where == "file.csv, line 1, column dx"
    assert KINDS[kind][1][0] in str(caught.value)
    assert not unit or not is_kind(unit, kind)


def test_a_slip_of_case_is_recognised() -> None:
    with pytest.raises(InputError, match="did you mean kN"):
        to_si(1.0, "KN", "force")


@given(st.text(max_size=20) | st.text(alphabet="mNradsuk*/^()-12 °µ·%", max_size=12))
def test_any_text_is_a_unit_or_an_input_error(text: str) -> None:
    if is_kind(text, "length"):
        assert is_unit(text)
        assert np.isfinite(to_si(1.0, text, "length"))
    else:
        with pytest.raises(InputError):
            to_si(1.0, text, "length")


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_numbers_that_are_not_finite_are_refused(bad: float) -> None:
    for convert in (to_si, from_si):
        with pytest.raises(InputError, match="finite"):
            convert([1.0, bad], "mm", "length")


@pytest.mark.parametrize(
    ("header", "parts"),
    [
        ("fx[N]", ("fx", "N")),
        (" fx [ N ] ", ("fx", "N")),
        ("pose", ("pose", None)),
        ("dx[]", ("dx", None)),
        ("joint_1_s[deg]", ("joint_1_s", "deg")),
    ],
)
def test_headers_split(header: str, parts: tuple[str, str | None]) -> None:
    assert split_header(header) == parts


@pytest.mark.parametrize("header", ["fx[N", "fx]N[", "[N]", "a[b][c]", "fx[N]x", "fx]"])
def test_broken_headers_are_refused(header: str) -> None:
    with pytest.raises(InputError, match=r"fx\[N\]"):
        split_header(header)


@pytest.mark.parametrize(
    ("text", "kind", "values"),
    [
        ("10,20,-30 deg", "angle", np.deg2rad([10, 20, -30])),
        ("10 20 -30deg", "angle", np.deg2rad([10, 20, -30])),
        ("1e3, .5 mm", "length", [1.0, 0.0005]),
        ("1 m, 5; 6 mm", "length", [1.0, 0.005, 0.006]),
        ("5 N", "force", [5.0]),
    ],
)
def test_values(text: str, kind: str, values: list[float]) -> None:
    np.testing.assert_allclose(parse_values(text, kind), values, rtol=1e-15)


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("10,20", "10,20,-30 deg"),
        ("", "empty place"),
        ("10,,20 deg", "empty place"),
        ("nan deg", "finite"),
        ("1e999 deg", "finite"),
        ("-inf deg", "finite"),
        ("1.2.3 deg", "not a number"),
        ("ten deg", "not a number"),
        ("10 deg, 20", "no unit"),
        ("10 mm", "angle"),
        ("1 deg, rad", "follows no number"),
    ],
)
def test_values_that_cannot_be_read(text: str, part: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_values(text, "angle", where="--between")
    assert part in str(caught.value)
    assert "--between" in str(caught.value)


NAMES = ("joint_1_s", "joint_2_l", "rail")
POSE_KINDS = ("angle", "angle", "length")


def test_poses() -> None:
    full = [np.pi / 18, np.pi / 9, 0.1]
    np.testing.assert_allclose(parse_pose("10, 20 deg, 100 mm", NAMES, POSE_KINDS), full)
    by_name = parse_pose("rail=100 mm, joint_1_s=10, joint_2_l = 20 deg", NAMES, POSE_KINDS)
    np.testing.assert_allclose(by_name, full)
    np.testing.assert_allclose(parse_pose("joint_2_l=20 deg", NAMES, POSE_KINDS), [0, np.pi / 9, 0])


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("10,20 deg", "2 values for 3 joints"),
        ("10,20,30 deg", "joint rail"),
        ("joint_2=20 deg", "did you mean 'joint_2_l'"),
        ("joint_2_l=20", "no unit"),
        ("joint_2_l=20 deg, joint_2_l=3 deg", "twice"),
        ("joint_2_l=20 deg, 3 deg", "names no joint"),
        ("joint_2_l=, rail=1 mm", "empty place"),
        ("joint_2_l=2 3 deg, rail=1 mm", "3 values for 2"),
        ("10,20,30", "0 deg, 0 deg, 0 mm"),
    ],
)
def test_poses_that_cannot_be_read(text: str, part: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_pose(text, NAMES, POSE_KINDS, where="--pose")
    assert part in str(caught.value)
    assert "--pose" in str(caught.value)


@pytest.mark.parametrize(
    ("text", "wrench"),
    [
        ("100,0,-200 N", [100, 0, -200, 0, 0, 0]),
        ("100,0,-200,0,0,5 N, N*m", [100, 0, -200, 0, 0, 5]),
        ("1,0,0 kN, 0,0,2 Nmm", [1000, 0, 0, 0, 0, 0.002]),
        ("1 2 3 4 5 6 N,Nm", [1, 2, 3, 4, 5, 6]),
    ],
)
def test_wrenches(text: str, wrench: list[float]) -> None:
    np.testing.assert_allclose(parse_wrench(text), wrench, rtol=1e-15)


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("100,0,-200", "100,0,-200 N"),
        ("100,0,-200,0 N", "4 numbers"),
        ("1,2,3,4,5,6 N", "the moments have none"),
        ("1,2,3 N, N*m", "2 units"),
        ("1,2,3,4,5,6 N, N", "moment"),
        ("1,2,3 mm", "force"),
        ("1,2,3,4,5,6 N*m, N", "force"),
        ("1,2,3,4,5,6 N, N*m, N", "3 units"),
    ],
)
def test_wrenches_that_cannot_be_read(text: str, part: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_wrench(text, where="--wrench")
    assert part in str(caught.value)
    assert "--wrench" in str(caught.value)


def test_an_example_says_how_many_numbers_there_must_be() -> None:
    assert parse_values("1,2,3 mm", "length", like="0,0,150 mm").shape == (3,)
    with pytest.raises(InputError, match="2 numbers, not 3") as refusal:
        parse_values("1,2 mm", "length", where="--point", like="0,0,150 mm")
    assert refusal.value.where == "--point" and "0,0,150 mm" in (refusal.value.remedy or "")
    assert parse_size("10 um", "length", where="--noise", like="10 um") == pytest.approx(1e-5)
    for bad in ("0 um", "-1 um", "1,2 um"):
        with pytest.raises(InputError):
            parse_size(bad, "length", where="--noise", like="10 um")
