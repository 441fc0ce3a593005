"""What a message shows to write is read again, and is of the key it speaks of."""

from __future__ import annotations

from pathlib import Path

import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements.table.settings import read_settings


@pytest.mark.parametrize(
    ("slip", "key"),
    [
        ("noise: {sigma: 10, unit: um, rotation: 20 urad}", "noise"),
        ("noise: {force: a hundredth}", "noise"),
        ("registered: {rotation: none}", "registered"),
        ("payload: {point: flange}", "payload"),
        ("rotation: target", "rotation"),
        ("force: sensor", "force"),
    ],
)
def test_the_example_is_of_the_key_that_slipped(tmp_path: Path, slip: str, key: str) -> None:
    """`rotation` and `force` are keys of noise, too, and mean something else there."""
    path = tmp_path / "noise.yaml"
    path.write_text(slip + "\n")
    with pytest.raises(InputError) as caught:
        read_settings(path)
    example = caught.value.remedy.removeprefix("Write it like  ")
    assert example != caught.value.remedy and example.startswith(f"{key}:")
    path.write_text(example + "\n")
    read_settings(path)
