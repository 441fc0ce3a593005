"""Pages of the site name what there is; `.ci/docs` builds them and runs what they show."""

import importlib.util
import json
import re
import runpy
from pathlib import Path
from types import ModuleType

import pytest

import sk120stiff as sk

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGES = sorted(page for page in DOCS.rglob("*.md") if not {"_build", "joss"} & set(page.parts))


def test_every_public_name_is_in_the_reference() -> None:
    page = (DOCS / "reference" / "python.md").read_text(encoding="utf-8")
    assert set(re.findall(r":: sk120stiff\.(\w+)", page)) == {*sk.__all__, "show"}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_is_in_the_contents(page: Path) -> None:
    contents = (DOCS / "index.md").read_text(encoding="utf-8")
    name = page.relative_to(DOCS).with_suffix("").as_posix()
    assert name == "index" or f"\n{name}\n" in contents


def test_every_tuned_number_stands_in_the_table_with_its_reason() -> None:
    script = runpy.run_path(str(DOCS.parent / "scripts" / "thresholds.py"))
    assert [n.name for n in script["numbers"]() if not n.reason] == []
    now = (DOCS / "THRESHOLDS.md").read_text(encoding="utf-8")
    assert now == script["table"](), "write it anew: python scripts/thresholds.py"


@pytest.mark.parametrize("name", ["fit", "explain", "own_effect"])
def test_a_notebook_is_kept_without_what_it_prints(name: str) -> None:
    cells = json.loads((DOCS / "notebooks" / f"{name}.ipynb").read_text(encoding="utf-8"))["cells"]
    code = [cell for cell in cells if cell["cell_type"] == "code"]
    assert len(code) > 5
    assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in code)


@pytest.fixture
def built() -> ModuleType:
    found = importlib.util.spec_from_file_location("built", DOCS / "extensions" / "built.py")
    assert found is not None and found.loader is not None
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


@pytest.mark.parametrize(
    ("body", "faults"),
    [
        ('<a href="b.html#there">b</a><a href="https://example.org">out</a>', 0),
        ('<a href="b.html#gone">b</a>', 1),
        ('<a href="c.html">c</a>', 1),
        ('<img src="https://example.org/a.png">', 1),
        ('<script src="//example.org/a.js"></script>', 1),
    ],
)
def test_links_of_the_built_site_are_checked(
    built: ModuleType, tmp_path: Path, body: str, faults: int
) -> None:
    (tmp_path / "a.html").write_text(f"<html><body>{body}</body></html>", encoding="utf-8")
    (tmp_path / "b.html").write_text('<html><body id="there"></body></html>', encoding="utf-8")
    assert built.main(tmp_path) == faults
    (tmp_path / "a.css").write_text("a {src: url('https://example.org/f.woff')}", encoding="utf-8")
    assert built.main(tmp_path) == faults + 1
