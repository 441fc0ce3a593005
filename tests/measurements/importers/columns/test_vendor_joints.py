"""Joints by the names of their makers."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff.errors import InputError
from tests.measurements.importers.reading import SIX, draft_of

SEVEN = (*SIX, "joint_7")


def text(names: list[str], more: str = "") -> str:
    cells = ",".join(str(k + 1) for k in range(len(names)))
    return f"x,y,z,{','.join(names)}{more and ',' + more}\n7,8,9,{cells}{more and ',5'}\n"


@pytest.mark.parametrize(
    ("names", "actuated"),
    [
        (list("SLURBT"), SIX), (list("slurbt"), SIX), (list("SLEURBT"), SEVEN),
        ([f"{letter} [deg]" for letter in "SLURBT"], SIX),
        ([f"{letter}-Achse" for letter in "SLURBT"], SIX),
        ([f"axis {letter}" for letter in "SLURBT"], SIX),
        (["Base", "Shoulder", "Elbow", "Wrist1", "Wrist2", "Wrist3"], SIX),
        (["base", "shoulder", "elbow", "wrist_1", "wrist_2", "wrist_3"], SIX),
        ([f"A{k}" for k in range(1, 8)], SEVEN), ([f"J{k}" for k in range(1, 8)], SEVEN),
        ([f"Achse {k}" for k in range(1, 7)], SIX), ([f"q{k}" for k in range(1, 7)], SIX),
        ([f"JT{k}" for k in range(1, 7)], SIX), ([f"Gelenk {k} (°)" for k in range(1, 7)], SIX),
    ],
)  # fmt: skip
def test_in_the_order_of_the_joints(
    names: list[str], actuated: tuple[str, ...], tmp_path: Path
) -> None:
    unit = {} if "[" in names[0] or "(" in names[0] else {"angle": "deg"}
    found = draft_of(tmp_path, text(names), actuated, length="mm", **unit)
    np.testing.assert_allclose(np.degrees(found.joints.values[0]), np.arange(1, len(names) + 1))
    first, last = (n.split(" [")[0].split(" (")[0] for n in (names[0], names[-1]))
    told = next(said for said in found.said if said.startswith("Joint columns"))
    assert f"{first} is joint_1" in told and f"{last} is {actuated[-1]}" in told


def test_columns_in_another_order_keep_their_names(tmp_path: Path) -> None:
    found = draft_of(tmp_path, text(list("TBRULS")), length="mm", angle="deg")
    np.testing.assert_allclose(np.degrees(found.joints.values[0]), [6, 5, 4, 3, 2, 1])


@pytest.mark.parametrize(
    ("names", "actuated"),
    [(list("SLURB"), SIX), (list("SLURBT"), SEVEN), (list("SLEURBT"), SIX), (list("SLURBX"), SIX)],
)
def test_letters_that_are_not_all_of_them_are_no_joints(
    names: list[str], actuated: tuple[str, ...], tmp_path: Path
) -> None:
    with pytest.raises(InputError, match="no joint values"):
        draft_of(tmp_path, text(names), actuated, length="mm", angle="deg")


def test_beside_numbered_joints_a_letter_is_a_letter(tmp_path: Path) -> None:
    content = text([f"q{k}" for k in range(1, 7)], "T")
    found = draft_of(tmp_path, content, length="mm", angle="deg")
    np.testing.assert_allclose(np.degrees(found.joints.values[0]), range(1, 7))
    assert found.unused == ("column T",)
