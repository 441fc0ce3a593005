"""The mass on the tool by whatever word and in whatever unit a table has it."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.columns.masses import with_masses
from sk120stiff.measurements.importers.drafting import Draft
from tests.measurements.importers.reading import draft_of

ROWS = "10,20,30,1,2,3,4,5,6,{}\n11,20,30,2,2,3,4,5,6,{}\n"


def read(folder: Path, header: str, cells: tuple[str, str], **told: object) -> Draft:
    text = f"x1,y1,z1,q1,q2,q3,q4,q5,q6,{header}\n" + ROWS.format(*cells)
    return draft_of(folder, text, length="mm", angle="deg", **told)


@pytest.mark.parametrize(
    ("header", "kilograms"),
    [
        ("Last (kg)", 1.0), ("Nutzlast [kg]", 1.0), ("Masse (kg)", 1.0), ("mass_kg", 1.0),
        ("weight (kg)", 1.0), ("Load (kg)", 1.0), ("payload [g]", 1e-3), ("Tool mass [g]", 1e-3),
        ("Poids (lb)", 0.45359237), ("weight [lbs]", 0.45359237), ("m1 [kg]", 1.0),
    ],
)  # fmt: skip
def test_a_column_in_a_unit_of_mass_is_the_payload(
    tmp_path: Path, header: str, kilograms: float
) -> None:
    found = read(tmp_path, header, ("0", "2.5"))
    assert found.loads.payload is not None
    np.testing.assert_allclose(found.loads.payload, [0.0, 2.5 * kilograms])
    np.testing.assert_allclose(found.loads.wrench[1, 2], -9.80665 * 2.5 * kilograms)
    assert not found.unused


def test_a_unit_that_nobody_said_is_asked_for(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="nobody said in which unit the column 'Nutzlast' is"):
        read(tmp_path, "Nutzlast", ("0", "2.5"))
    found = read(tmp_path, "Nutzlast", ("0", "2.5"), load="kg")
    np.testing.assert_allclose(found.loads.payload, [0.0, 2.5])


@pytest.mark.parametrize("header", ["weight", "last", "mass"])
def test_words_that_mean_much_need_a_unit(tmp_path: Path, header: str) -> None:
    found = read(tmp_path, header, ("0", "2.5"))
    assert found.loads.payload is None and len(found.unused) == 1


def test_of_several_masses_the_one_that_is_called_so(tmp_path: Path) -> None:
    names, units = ["m1", "Nutzlast", "x"], ["kg", "g", "mm"]
    known = [None, None, ("x", 1.0)]
    assert with_masses(names, known, units) == (
        [None, ("payload", 1e-3), ("x", 1.0)], ["kg", "kg", "mm"],
    )  # fmt: skip
    assert with_masses(["m1", "m2"], [None, None], ["kg", "kg"]) == ([None, None], ["kg", "kg"])
    assert with_masses(["fx", "mass"], [("fx", 1.0), None], ["N", "kg"])[0][1] is None
    assert with_masses(["load"], [("load", 1.0)], [None]) == ([("load", 1.0)], [None])


def test_a_mass_beside_a_load_that_is_counted_stays_what_it_was() -> None:
    names = ["load", "tool mass"]
    assert with_masses(names, [("load", 1.0), None], [None, "kg"])[0] == [("load", 1.0), None]
    both = [("payload", 1.0), None]
    assert with_masses(["payload", "m2"], both, [None, "kg"])[0] == both
