"""Whatever a YAML file holds, it becomes plain values or one message about the file."""

import pytest

from sk120stiff.errors import InputError
from sk120stiff.files import parse_yaml

LAUGHS = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{b}: &{b} [{', '.join([f'*{a}'] * 9)}]\n" for a, b in zip("abcdefgh", "bcdefghi", strict=True)
)


@pytest.mark.parametrize(
    ("text", "what", "where"),
    [
        ("a: 1\nb: !!float x\n", "'x' cannot be read as a number", "f.yaml, line 2"),
        ("a: 2001-99-99", "'2001-99-99' cannot be read as a date", "f.yaml, line 1"),
        ("a: [1, {b: 0000-00-00}]", "cannot be read as a date", "line 1"),
        ("a: !!bool maybe", "'maybe' cannot be read as a bool", "line 1"),
        ("a: !!timestamp x", "cannot be read as a date", "line 1"),
        ("a: " + "1" * 5000, "cannot be read as a number", "line 1"),
        ("a: &a [*a]", "contains itself", "line 1"),
        ("a: &a\n  b: {c: *a}", "contains itself", "line"),
        (LAUGHS, "unfolds to more than", "f.yaml"),
        ("a: " + "[" * 60 + "]" * 60, "nested too deeply", "f.yaml"),
        ("[" * 5000 + "]" * 5000, "nested too deeply", "f.yaml"),
        ("? [a]\n: b", "not YAML", "line 1"),
        ("!!python/object/apply:os.getcwd []", "not YAML", "line 1"),
        ("a: b: c", "not YAML", "line 1, column 5"),
        ("a: \x07", "not YAML", "f.yaml"),
    ],
)  # fmt: skip
def test_one_message(text: str, what: str, where: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_yaml(text, "f.yaml")
    assert what in caught.value.what
    assert where in (caught.value.where or "")
    assert caught.value.remedy
    assert len(str(caught.value)) < 300


def test_aliases_and_dates_that_make_sense_are_kept() -> None:
    content = parse_yaml("a: &x [1, 2]\nb: *x\nc: 2001-09-09\n", "f").content
    assert isinstance(content, dict)
    assert content["b"] == [1, 2] and content["c"].year == 2001
    assert parse_yaml("", "f").content is None
