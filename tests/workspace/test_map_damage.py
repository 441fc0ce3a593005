"""Damage of every kind to a map, and two runs on one: it is told, and mended without the rest."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from sk120stiff.errors import InputError, Refusal
from sk120stiff.workspace import (
    MapJob,
    MapReport,
    open_map,
    summarise_map,
    verify_map,
    write_map,
)
from sk120stiff.workspace.mapping import only_writer
from tests.attacks.maps import HARMS, flip, remove
from tests.workspace.arms import joint_job
from tests.workspace.test_map import SMALL, contents

ROOT = Path(__file__).resolve().parents[2]


def small_map(path: Path) -> MapReport:
    return write_map(job(), path, chunk_points=SMALL)


def job() -> MapJob:
    return joint_job(9, 8, 7, with_directions=True)


def test_damage_to_any_file_is_told(tmp_path: Path) -> None:
    path = tmp_path / "m.zarr"
    small_map(path)
    whole = contents(path)
    told = 0
    for name, data in whole.items():
        for harm in HARMS:
            if (name, harm) == ("manifest.json", remove):
                continue  # then there is no finished map: told as such
            harm(path / name)
            check = verify_map(path)
            assert {*check.damaged, *check.missing} == {name}
            (path / name).write_bytes(data)
            told += 1
    assert told > 100
    assert {"zarr.json", "load/c/0", "wrench/c/0/0", "joint_2_l/c/0", "identity.json",
            "stability/zarr.json"} < set(whole)  # fmt: skip
    assert verify_map(path).intact


RESULT, COORDINATE = "minimum_stiffness/c/0/1/0/0", "joint_2_l/c/0"


@pytest.mark.parametrize(
    ("names", "share"),
    [
        (("zarr.json",), 0.0),
        (("identity.json", "wrench/c/0/0", COORDINATE, "load/zarr.json"), 0.0),
        ((RESULT,), 0.5),
        ((RESULT, "zarr.json", "stability/zarr.json"), 0.5),
        (("manifest.json",), 1.0),  # then nothing vouches for the results
    ],
)
def test_a_finished_map_is_mended_and_nothing_else_computed(
    tmp_path: Path, names: tuple[str, ...], share: float
) -> None:
    path = tmp_path / "m.zarr"
    small_map(path)
    whole = contents(path)
    for k, name in enumerate(names):
        HARMS[k](path / name)
    report = small_map(path)
    assert set(report.mended) == set(names)
    assert report.computed == pytest.approx(share * report.points, abs=0.3 * share * report.points)
    assert contents(path) == whole


def test_a_falsified_coordinate_gives_no_pose(tmp_path: Path) -> None:
    """A readable coordinate that is another one moved the softest pose without a word."""
    import zarr

    path = tmp_path / "m.zarr"
    small_map(path)
    group = zarr.open_group(path, mode="r+", use_consolidated=False)
    group["joint_2_l"][:] = group["joint_2_l"][:] + 0.3
    with pytest.raises(Refusal, match=r"joint_2_l.*makes what is damaged anew"):
        summarise_map(path)
    with pytest.raises(Refusal, match="not as they were written"):
        open_map(path)


def test_a_chunk_damaged_before_the_end_is_computed_again(tmp_path: Path) -> None:
    path, whole = tmp_path / "m.zarr", tmp_path / "whole.zarr"
    small_map(whole)
    computed: list[int] = []

    class Stop(Exception):
        pass

    def stop(done: int, total: int) -> None:
        if done > 0.4 * total:
            raise Stop

    with pytest.raises(Stop):
        write_map(job(), path, chunk_points=SMALL, progress=stop)
    record = json.loads(next((path / ".progress").glob("*.json")).read_text())
    victim = next(file for file in record["files"] if file.startswith("mean_stiffness"))
    flip(path / victim)
    flip(path / "wrench/c/0/0")
    computed.append(small_map(path).computed)
    assert contents(path) == contents(whole)


def test_two_runs_at_once_leave_one_whole_map(tmp_path: Path) -> None:
    program = (
        "import sys\n"
        "from sk120stiff.errors import InputError\n"
        "from sk120stiff.workspace import write_map\n"
        "from tests.workspace.arms import joint_job\n"
        "job = joint_job(24, 16, 20)\n"
        "sys.stdin.readline()\n"
        "try:\n    write_map(job, sys.argv[1], chunk_points=300)\n"
        "except InputError as error:\n    print(error)\n    sys.exit(2)\n"
    )
    path, whole = tmp_path / "m.zarr", tmp_path / "whole.zarr"
    runs = [
        subprocess.Popen(
            [sys.executable, "-c", program, str(path)],
            cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )
        for _ in range(2)
    ]  # fmt: skip
    time.sleep(0.1)
    for run in runs:
        assert run.stdin is not None
        run.stdin.write("go\n")
        run.stdin.flush()
    said = [run.communicate(timeout=120)[0] for run in runs]
    codes = sorted(run.returncode for run in runs)
    assert codes in ([0, 2], [0, 0])  # the second may come when the first is done
    assert any(f"process {run.pid}" in text for run in runs for text in said) or codes == [0, 0]
    write_map(joint_job(24, 16, 20), whole, chunk_points=SMALL)
    assert contents(path) == contents(whole)


def test_a_lock_names_its_writer_and_dies_with_it(tmp_path: Path) -> None:
    path = tmp_path / "m.zarr"
    program = (
        "import sys, time, pathlib\n"
        "from sk120stiff.workspace.mapping import only_writer\n"
        "with only_writer(pathlib.Path(sys.argv[1])):\n    print('held', flush=True)\n"
        "    time.sleep(100)\n"
    )
    holder = subprocess.Popen(
        [sys.executable, "-c", program, str(path)], stdout=subprocess.PIPE, text=True
    )
    assert holder.stdout is not None
    assert holder.stdout.readline() == "held\n"
    with pytest.raises(InputError, match=f"process {holder.pid}"):
        small_map(path)
    assert not path.exists()
    os.kill(holder.pid, signal.SIGKILL)
    holder.wait()
    assert (tmp_path / ".m.zarr.lock").exists()
    with only_writer(path):
        pass
    assert small_map(path).computed == 9 * 8 * 7


def test_only_our_own_maps_are_overwritten(tmp_path: Path) -> None:
    """A Zarr store of somebody else's is not ours to remove."""
    import zarr

    foreign = tmp_path / "foreign.zarr"
    zarr.create_group(foreign, attributes={"identity": "mine", "title": "my data"})
    before = contents(foreign)
    for overwrite in (False, True):
        with pytest.raises(InputError, match="no map") as caught:
            write_map(job(), foreign, overwrite=overwrite)
        assert "overwrite" not in str(caught.value.remedy)
    assert contents(foreign) == before
    (tmp_path / "empty.zarr").mkdir()
    assert small_map(tmp_path / "empty.zarr").computed == 9 * 8 * 7


def test_what_a_killed_run_left_beside_the_map_is_cleared(tmp_path: Path) -> None:
    (tmp_path / ".m.zarr.new-abc").mkdir()
    (tmp_path / ".other.zarr.new-abc").mkdir()
    small_map(tmp_path / "m.zarr")
    assert sorted(p.name for p in tmp_path.iterdir()) == [".other.zarr.new-abc", "m.zarr"]


def test_checking_what_is_there_tells_its_progress(tmp_path: Path) -> None:
    path = tmp_path / "m.zarr"
    report = small_map(path)
    told: list[tuple[int, int]] = []
    write_map(job(), path, chunk_points=SMALL, checking=lambda *done: told.append(done))
    assert told == [(k, report.chunks) for k in range(report.chunks)]
    told.clear()
    files = verify_map(path, progress=lambda *done: told.append(done)).files - 1
    assert told == [(k, files) for k in range(files)]
    told.clear()
    summarise_map(path, progress=lambda *done: told.append(done))
    assert told == [(k, report.chunks) for k in range(report.chunks)]
