"""Chinese headers, as trackers sold in China write them, in UTF-8 and as Excel saves them."""

from pathlib import Path

import pytest

from sk120stiff.measurements.importers.columns.chinese import in_english
from sk120stiff.measurements.importers.columns.words import meaning_of, unit_of_header
from tests.measurements.importers.reading import sheet_of

ONE = ("joint_1",)
REPORT = "名称,名义 X,名义 Y,名义 Z,测量 X（毫米）,测量 Y（毫米）,测量 Z（毫米）,关节1（度）,余量\n"
ROWS = "P1,10,20,30,10.1,20.1,30.1,5,0.1\nP2,40,50,60,40.1,50.1,60.1,6,0.1\n"


@pytest.mark.parametrize(
    ("header", "meaning", "unit"),
    [
        ("测量X", "measured x", None),
        ("X坐标（毫米）", "x", "mm"),
        ("名义 Y", "nominal y", None),
        ("偏差Z", "deviation z", None),
        ("关节角2（度）", "joint 2", "deg"),
        ("轴3", "joint 3", None),
        ("位移X [毫米]", "dx", "mm"),
        ("力 Z（牛）", "fz", "N"),
        ("测量 Rx", "measured orientation x", None),
        ("环境温度", "temperature", None),
        ("点号", "name", None),
        ("负载（公斤）", "payload", "kg"),
    ],
)
def test_headers_mean_what_they_say(header: str, meaning: str, unit: str | None) -> None:
    name, stated = unit_of_header(header)
    found = meaning_of(name)
    assert stated == unit
    assert found is not None and found[0] == meaning


def test_other_headers_are_left_alone() -> None:
    for header in ("Größe [mm]", "Q1 ", "x", "déplacement x", ""):
        assert in_english(header) is header


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "gbk", "gb18030"])
def test_a_report_is_read_in_every_encoding(tmp_path: Path, encoding: str) -> None:
    sheet = sheet_of(tmp_path, (REPORT + ROWS).encode(encoding), ONE)
    x, joint = sheet.get("x"), sheet.get("joint 1")
    assert x is not None and x.cells == ("10.1", "40.1") and x.unit == "mm"
    assert joint is not None and joint.unit == "deg"
    assert [column.header for column in sheet.spare] == ["余量"]


def test_umlauts_are_not_taken_for_chinese(tmp_path: Path) -> None:
    text = "Name;x [µm];y [µm];z [µm];Größe;Öß\nP1;1;2;3;4;5\nP2;2;3;4;5;6\n"
    sheet = sheet_of(tmp_path, text.encode("cp1252"), ONE)
    x = sheet.get("x")
    assert x is not None and x.unit in ("µm", "um")
    assert [column.header for column in sheet.spare] == ["Größe", "Öß"]
