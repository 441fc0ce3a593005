"""Scripts of the gallery stay short and public; `.ci/docs` runs every one of them."""

import ast
from pathlib import Path

import pytest

GALLERY = Path(__file__).resolve().parents[2] / "docs/gallery"
SCRIPTS = sorted(GALLERY.glob("*.py"))
LONGEST = 40  # lines


def test_there_are_enough() -> None:
    assert len(SCRIPTS) >= 20


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_a_script_is_short_and_needs_the_public_names_alone(script: Path) -> None:
    text = script.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= LONGEST
    modules = [
        name.name if isinstance(node, ast.Import) else f"{node.module}.{name.name}"
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Import | ast.ImportFrom)
        for name in node.names
    ]
    assert [name for name in modules if name.startswith("sk120stiff")] == ["sk120stiff"]
    assert "import sk120stiff as sk" in text and "plt.show()" in text
