"""Columns that name points or poses, in the languages of laboratories."""

from pathlib import Path

import pytest

from sk120stiff.measurements.importers.columns.label_words import with_labels
from sk120stiff.measurements.importers.columns.words import meaning_of
from tests.measurements.importers.reading import sheet_of


@pytest.mark.parametrize(
    "header",
    [
        "Punto", "Nr", "Nr.", "Messpunkt", "Messpunkt-Nr.", "N°", "Nº", "№", "点", "測点", "点号",
        "Point no.", "Point #", "Punkt Nr.", "Pkt", "Ponto", "Point de mesure", "Punto di misura",
        "Punto de medición", "Ponto de medição", "Número", "Numéro", "Num. punto", "Meetpunt",
        "PointID", "Target name", "Точка",
    ],
)  # fmt: skip
def test_points(header: str) -> None:
    assert meaning_of(header) == ("name", 1.0)


@pytest.mark.parametrize(
    "header",
    ["Pose", "Pose#", "Pose n°", "N° de pose", "Nr. Stellung", "PoseNr", "Robot pose", "姿态",
     "Numero postura", "Posa"],
)  # fmt: skip
def test_poses(header: str) -> None:
    assert meaning_of(header) == ("pose", 1.0)


@pytest.mark.parametrize(
    "header", ["Point x", "N", "Position", "零点", "Pointer", "Row", "No load"]
)
def test_other_words(header: str) -> None:
    known = meaning_of(header)
    assert known is None or known[0] not in ("name", "pose")


@pytest.mark.parametrize("header", ["Posição", "Posizione", "Posición", "Position", "Versuch Nr."])
def test_words_that_may_mean_more_are_labels_where_no_other_column_is(header: str) -> None:
    assert with_labels([header, "x"], [None, ("x", 1.0)], [None, "mm"])[0] == ("name", 1.0)
    assert with_labels([header, "x"], [None, ("x", 1.0)], ["mm", "mm"])[0] is None
    assert with_labels([header, "Nr"], [None, ("name", 1.0)], [None, None])[0] is None


def test_a_number_sign_above_a_column_begins_no_comment(tmp_path: Path) -> None:
    sheet = sheet_of(tmp_path, "#,X [mm],Y [mm],Z [mm]\n1,1,2,3\n2,4,5,6\n")
    column = sheet.get("name")
    assert column is not None and column.cells == ("1", "2")


def test_what_counts_rows_is_no_label_beside_what_names_points() -> None:
    def meanings(*headers: str) -> list[tuple[str, float] | None]:
        known = [meaning_of(header) for header in headers]
        return with_labels(headers, known, [None] * len(headers))

    name = ("name", 1.0)
    assert meanings("Nr", "Messpunkt", "x") == [None, name, ("x", 1.0)]
    assert meanings("Nr", "x") == [name, ("x", 1.0)]
    assert meanings("Nr", "Pose") == [name, ("pose", 1.0)]
