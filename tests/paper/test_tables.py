"""Tables and the document: what is printed, written and handed to other programs."""

import csv
import io
import json

import numpy as np

from sk120stiff.files.json_text import as_json_text
from sk120stiff.paper.tables import Column, SideBySide, as_document, side_by_side

NAMES = [
    "table2_gaps", "table2", "identified", "table3", "table4", "critical", "appendix",
    "diagonal_parts", "claims",
]  # fmt: skip


def test_csv_has_units_and_every_row(found):
    tables = {table.name: table for table in side_by_side(found)}
    assert list(tables) == NAMES
    sizes = {"table2": 15, "table3": 25, "table4": 8, "appendix": 9, "claims": len(found.claims)}
    for name, table in tables.items():
        header, *rows = csv.reader(io.StringIO(table.csv()))
        assert {len(row) for row in rows} == {len(header)}
        assert len(rows) == sizes.get(name, len(rows)) > 2
    header, first, *_ = csv.reader(io.StringIO(tables["table2"].csv()))
    row = dict(zip(header, first, strict=True))
    assert float(row["force y[N]"]) == 72.922
    assert float(row["calculated, theirs x[um]"]) == -28.8
    assert abs(float(row["ours, exact y[um]"]) - 160.0) < 0.3


def test_columns():
    column = Column("d", np.array([[-0.04, 12.5, 3.0], [100.0, -7.25, 0.0]]), "um", 1)
    table = SideBySide("t", "T", (Column("pose", ["a", "b"]), column))
    assert column.texts == ["  0.0 12.5 3.0", "100.0 -7.2 0.0"]
    assert table.columns[0].texts == ["a", "b"]
    assert column.shown_unit == "µm"
    assert table.csv().splitlines() == [
        "pose,d x[um],d y[um],d z[um]", "a,-0.0400,12.5000,3.0000", "b,100.0000,-7.2500,0.0000",
    ]  # fmt: skip


def test_document_is_json_with_the_promised_keys(found):
    document = json.loads(as_json_text(as_document(found)))
    assert {"table2", "table3", "table4", "identified", "claims", "critical", "appendix"} <= set(
        document
    )
    table2 = document["table2"]
    assert [round(x, 2) for x in table2["calculated_rms_um"]["conventional"].values()] == [
        0.18, 0.24, 0.06,
    ]  # fmt: skip
    assert all(x < 0.3 for x in table2["calculated_rms_um"]["enhanced"].values())
    assert all(x < 0.3 for x in table2["calculated_rms_um"]["equilibrium"].values())
    assert len(table2["rows"]) == 15 and len(document["table3"]["rows"]) == 25
    names = [p["name"] for p in document["identified"]["parameters"]]
    assert names[0] == "joint_springs:joint_1_s.stiffness"
    assert all(
        p["std"] > 0 and p["unit"] == "N*m/rad" for p in document["identified"]["parameters"]
    )
    case = document["table4"]["cases"][1]
    assert case["paper PD"] == case["det > 0"] == 2785
    assert case["true PD"] == 703
    assert document["table4"]["cases_reproduced_by_determinant"] == [2, 4]
    assert document["critical"]["smallest"] > 3e5
    assert document["appendix"]["slips"][-1]["element"] == "J21"
    assert all({"where", "claim", "verdict", "evidence"} <= set(c) for c in document["claims"])
