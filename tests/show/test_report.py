"""The report: one file, nothing from a network, readable by machine and man."""

import hashlib
import itertools
import re
from html.parser import HTMLParser

import numpy as np
import pytest

from sk120stiff.errors import InputError
from sk120stiff.show import (
    Code,
    Items,
    KeyFigure,
    KeyFigures,
    Note,
    Picture,
    Report,
    SceneFrame,
    Section,
    Table,
    reproducibility,
)
from sk120stiff.show.figures import gap_per_pose
from tests.show.scenes import sk120_scene

EVIL = "</style><script>alert(1)</script>"
VOID = {"meta", "link", "br", "input", "hr", "img"}


class Outline(HTMLParser):
    """Tags in order, with attributes; complains about what is left open."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open, f"</{tag}> closes nothing"
        assert self.open.pop() == tag

    def of(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.tags if name == tag]


@pytest.fixture(scope="module")
def page() -> str:
    figure = gap_per_pose(["1", "2"], {"before": [4e-5, 3e-5]})
    return Report(
        f"Title {EVIL}",
        subtitle="`code`, **strong** and **5 N*m/rad, 2 N*m**2 or so**",
        lead="The answer.",
        sections=[
            Section(
                "Result",
                [
                    KeyFigures([KeyFigure("rms gap", "9.8", "µm", "was 41")]),
                    f"A paragraph {EVIL}",
                    Picture(figure, "Bars, one for each pose", "What they mean"),
                    Table(
                        ["name", "value", "note"],
                        [["a", -1.40981e6, "x"], ["b", None, "y"], ["c", float("inf"), "z"]],
                        "Springs",
                        units=["", "N·m/rad", ""],
                    ),
                ],
            ),
            Section("Result", [Note("careful", "caution"), Section("Deeper", [Items(["i", "j"])])]),
            Section(
                "Scene", [SceneFrame(sk120_scene(), "SK120", link="scene.html"), Code("x < y")]
            ),
        ],
        reproducibility=reproducibility("sk120stiff demo"),
    ).html()


@pytest.fixture(scope="module")
def outline(page: str) -> Outline:
    found = Outline(page)
    assert not found.open
    return found


def test_headings_step_down_one_level_at_a_time(outline: Outline) -> None:
    levels = [int(tag[1]) for tag, _ in outline.tags if re.fullmatch(r"h[1-6]", tag)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(after <= before + 1 for before, after in itertools.pairwise(levels))


def test_ids_are_unique_and_links_inside_the_page_arrive(outline: Outline) -> None:
    ids = [attributes["id"] for _, attributes in outline.tags if attributes.get("id")]
    assert len(ids) == len(set(ids))
    for attributes in outline.of("a"):
        target = attributes["href"] or ""
        assert target == "scene.html" or target[1:] in ids


def test_everything_visual_has_a_text(outline: Outline) -> None:
    figures = [a for a in outline.of("svg") if a.get("role") == "img"]
    assert figures
    assert all(a["aria-label"] for a in figures)
    assert all(a["title"] for a in outline.of("iframe"))
    assert not outline.of("img")
    assert outline.tags[0] == ("html", {"lang": "en"})


def test_nothing_comes_from_elsewhere(outline: Outline, page: str) -> None:
    for tag, attributes in outline.tags:
        for name in ("src", "href", "xlink:href", "data", "action"):
            value = attributes.get(name)
            assert not value or value.startswith("#") or value == "scene.html", (tag, value)
    assert outline.of("script") == [{}]  # what puts a still of the scene on paper
    assert "//" not in page.rpartition("<script>")[2].replace("// ", "")


def test_text_stays_text(page: str) -> None:
    assert EVIL not in page.split("srcdoc=")[0]
    assert "&lt;script&gt;alert(1)" in page
    assert "<code>code</code>" in page
    assert "<strong>strong</strong>" in page
    assert "<strong>5 N*m/rad, 2 N*m**2 or so</strong>" in page


def test_numbers_are_written_as_people_write_them(page: str) -> None:
    assert "−1.410·10⁶" in page
    assert "∞" in page
    assert '<td class="right">–</td>' in page


def test_tables_name_their_rows_and_columns(outline: Outline) -> None:
    scopes = [attributes.get("scope") for attributes in outline.of("th")]
    assert scopes.count("col") == 3
    assert scopes.count("row") == 3


def test_it_prints(page: str) -> None:
    assert "@media print" in page
    assert "@page" in page


def test_written_whole_or_not_at_all(tmp_path, monkeypatch) -> None:
    target = tmp_path / "report.html"
    target.write_text("old")

    def fail(*_: object) -> None:
        raise OSError("disk full")

    monkeypatch.setattr("sk120stiff.files.writing.os.replace", fail)
    with pytest.raises(OSError, match="disk full"):
        Report("New").write(target)
    assert target.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["report.html"]


def test_inputs_are_named_by_their_hash(tmp_path) -> None:
    data = tmp_path / "data.csv"
    data.write_text("a,b\n")
    facts = reproducibility("command", [data, tmp_path / "gone.csv"], seed=7)
    assert facts["SHA-256 of data.csv"] == hashlib.sha256(b"a,b\n").hexdigest()
    assert facts["SHA-256 of gone.csv"] == "missing"
    assert facts["Seed"] == "7"
    assert np.__version__ in facts["Versions"]


@pytest.mark.parametrize(
    "make",
    [
        lambda: Table(["a", "b"], [["x"]], "short row"),
        lambda: Table(["a", "b"], [], "units", units=["m"]),
    ],
)
def test_tables_that_do_not_fit_are_refused(make) -> None:
    with pytest.raises(InputError):
        make()


def test_thousands_of_micrometres_are_written_out() -> None:
    table = Table(["line", "before"], [["10", 1117.6], ["7", 40123.0]], "Worst.", digits=3)
    page = Report("Sheet", [Section("Worst", [table])]).html()
    assert "1118" in page and "4.01·10⁴" in page
