"""The numbers that steer `explain`, changed one at a time."""

import importlib
import runpy
import sys
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).parents[2] / "scripts"


@pytest.fixture(scope="module")
def script():
    before = list(sys.path)
    sys.path.insert(0, str(SCRIPTS))
    found = runpy.run_path(str(SCRIPTS / "thresholds_effect.py"))
    sys.path[:] = before
    return found


@pytest.mark.parametrize(("name", "said"), [("WIDE", [6, 2.0]), ("NEAR", [3, 6])])
def test_a_changed_number_is_changed_in_defaults_too(script, tmp_path, monkeypatch, name, said):
    (tmp_path / "made_up_numbers.py").write_text(
        "WIDE = 3\nNEAR, FAR = 2.0, 5.0\ndef told(wide=WIDE):\n    return [wide, NEAR]\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(
        sys, "meta_path", [script["_Changed"]("made_up_numbers", name, 6), *sys.meta_path]
    )
    monkeypatch.delitem(sys.modules, "made_up_numbers", raising=False)
    assert importlib.import_module("made_up_numbers").told() == said
    del sys.modules["made_up_numbers"]


def test_who_reads_a_number_is_found(script):
    readers = script["_readers"]()
    beside_form = readers["explain/judge/attribution.py", "MARGIN"]
    assert {place.partition(":")[0] for place in beside_form} >= {
        "explain/judge/attribution.py", "explain/judge/beside_form.py",
    }  # fmt: skip
    assert "explain/select/beam.py:" in readers["explain/select/beam.py", "BEAM"]  # a default
    assert all(readers.values())
