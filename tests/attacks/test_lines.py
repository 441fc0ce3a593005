"""A bounded part of every line that `scripts/attacks.py` prints."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path

import pytest

from scripts.attacks import lines
from tests.attacks import bending, disks, environments, maps, options, pages, readings, robots
from tests.attacks.judge import Verdict

ROOT = Path(__file__).resolve().parents[2]
Line = Callable[[Path], Iterator[Verdict]]
BOUNDED: dict[str, tuple[Line, int]] = {  # line → a part of it, attacks at most
    "mutated robots": (lambda folder: robots.mutated_robots(folder, 60, 5000), 60),
    "hostile robots": (robots.hostile_robots, 19),
    "options": (lambda folder: options.options(folder, 15, 7), 15),
    "variables": (environments.variables, 2),
    "limits": (environments.limits, 2),
    "damaged maps": (lambda folder: maps.damage(folder, every=67), 9),
    "full disk": (lambda folder: disks.full_disk(folder, sizes=(80,)), 1),
    "garbage": (lambda folder: readings.garbage(folder, only=1), 6),
    "slips of the pen": (lambda folder: readings.slips(folder, seeds=(3,), every=40), 9),
    "scale slips": (lambda folder: readings.scale_slips(folder, seeds=()), 30),
    "beyond buckling": (lambda folder: bending.bending(folder, 6, 100), 6),
    "hostile requests": (pages.hostile_requests, 200),
}
ELSEWHERE = {  # lines whose bounded part has a test of its own
    "overwriting": "attacks/test_outputs.py::test_an_input_is_never_replaced",
    "interrupts": "test_files.py::test_ctrl_c_in_the_moment_of_change_waits",
    "streams": "cli/test_environment.py::test_closed_streams_are_told_by_the_exit_code",
    "strangers": "attacks/test_outputs.py::test_what_is_no_file_is_not_replaced",
    "killed maps": "workspace/test_map.py::test_a_killed_run_loses_at_most_the_chunk_it_was_at",
    "two runs on a map": "workspace/test_map_damage.py::test_two_runs_at_once_leave_one_whole_map",
    "floods": "show/test_live.py::test_a_flood_is_not_computed_and_ends_its_own_page",
    "load": "attacks/test_loads.py::test_a_large_size_is_answered_in_bounded_memory",
}


@pytest.mark.parametrize("name", BOUNDED)
def test_nothing_is_lost(name: str, tmp_path: Path) -> None:
    line, most = BOUNDED[name]
    found = list(islice(line(tmp_path / "desk"), most))
    assert [each for each in found if each.loss] == []
    assert found or name == "full disk"  # needs a file system of its own


def test_every_line_of_the_script_has_its_part_in_the_suite() -> None:
    printed = {name for name in lines(1, 0) if not name.startswith("mutated ") or "robots" in name}
    assert printed == {*BOUNDED, *ELSEWHERE}
    for place in ELSEWHERE.values():
        file, _, test = place.partition("::")
        assert f"def {test}" in (ROOT / "tests" / file).read_text(encoding="utf-8"), place


@pytest.mark.parametrize("command", ["explain", "simulate", "plan"])
def test_a_negative_seed_is_bad_usage(run, command: str, tmp_path: Path) -> None:
    model = str(ROOT / "robots/motoman_sk120/model.yaml")
    data = str(ROOT / "robots/motoman_sk120/data/table2_measured.csv")
    words = {"explain": [data], "simulate": [model, data], "plan": ["--model", model]}[command]
    outcome = run(command, *words, "--out", str(tmp_path / "out"), "--seed", "-1")
    assert outcome.code == 2
    assert "--seed" in outcome.stderr and "greater than or equal to 0" in outcome.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_name_that_no_file_can_have_is_bad_input(run, tmp_path: Path) -> None:
    data = str(ROOT / "robots/motoman_sk120/data/table2_measured.csv")
    out = str(tmp_path / "i.csv")
    outcome = run("import", data, "--robot", "a" * 5000, "--out", out, "--json")
    assert outcome.code == 2
    assert outcome.error["kind"] == "input"


@pytest.mark.parametrize("place", ["rob", "link"])
def test_new_replaces_nothing(run, place: str, tmp_path: Path, monkeypatch) -> None:
    """Not the robot's own folder, nor through a link, nor what a link in the folder leads to."""
    from tests.attacks.outputs import content, desk_of_outputs

    desk_of_outputs(tmp_path)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "link").symlink_to("rob")
    before = content(tmp_path)
    outcome = run("new", "rob", "--out", place)
    assert outcome.code == 2 and "nothing is replaced" in outcome.stderr
    (tmp_path / "half").mkdir()
    (tmp_path / "half" / "readings.csv").symlink_to("../m.csv")
    outcome = run("new", "rob", "--out", "half")
    assert outcome.code == 2 and "nothing is replaced" in outcome.stderr
    outcome = run("new", "rob", "--out", "m.csv")
    assert outcome.code == 2
    (tmp_path / "half" / "readings.csv").unlink()
    assert content(tmp_path) == before
    assert list((tmp_path / "half").iterdir()) == []
