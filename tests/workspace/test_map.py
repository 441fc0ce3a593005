"""Maps against the functions of `stiffness`, and what happens when writing them goes wrong."""

import errno
import json
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sk120stiff.errors import InputError, Refusal
from sk120stiff.robot import load_robot
from sk120stiff.stiffness import (
    cartesian_compliance,
    complementary_stiffness,
    definiteness,
    principal_stiffness,
    spring_matrix,
)
from sk120stiff.workspace import (
    STATUS,
    Axis,
    Grid,
    MapJob,
    PositionGrid,
    open_map,
    summarise_map,
    verify_map,
    write_map,
)
from sk120stiff.workspace import store as store_module
from sk120stiff.workspace.store import MapStore
from tests.stiffness.arms import critical_load
from tests.workspace.arms import LOADS, joint_job, sk120

SPRINGS = np.array([1.4098e6, 4.0076e5, 9.3528e5])


SMALL = 300  # points of a chunk


def contents(folder: Path) -> dict[str, bytes]:
    """Every file of a folder, byte for byte."""
    files = (path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


def test_values_are_those_of_the_functions(tmp_path: Path) -> None:
    job = joint_job(9, 8, 7, with_directions=True)
    report = write_map(job, tmp_path / "m.zarr", chunk_points=SMALL)
    assert report.points == report.computed == 9 * 8 * 7
    assert report.chunks > 1
    dataset = open_map(tmp_path / "m.zarr")
    assert dataset["minimum_stiffness"].attrs["units"] == "N/m"
    assert dataset["joint_2_l"].attrs["units"] == "rad"
    robot = load_robot("motoman_sk120")
    for where in ((0, 0, 0), (8, 7, 6), (3, 5, 2)):
        a = np.array([0.2, 0.0, 0.0, 0.3, 0.0, 0.1])
        here = dataset.isel(joint_2_l=where[0], joint_3_u=where[1], joint_5_b=where[2])
        a[[1, 2, 4]] = here["joint_2_l"], here["joint_3_u"], here["joint_5_b"]
        screws = robot.screws(a)
        for number, load in enumerate(LOADS):
            K_C = complementary_stiffness(screws, load)[:3, :3]
            compliance = cartesian_compliance(
                screws.linear_jacobian[:, :3], spring_matrix(SPRINGS) - K_C
            )
            principal = principal_stiffness(compliance)
            of_load = here.isel(load=number)
            expected = {
                "minimum_stiffness": principal.values[0],
                "maximum_stiffness": principal.values[2],
                "mean_stiffness": 3.0 / np.trace(compliance),
                "stability": definiteness(spring_matrix(SPRINGS) - K_C),
                "K_C_definiteness": definiteness(K_C),
            }
            for name, value in expected.items():
                np.testing.assert_allclose(of_load[name], value, rtol=1e-6)
            along = np.abs(of_load["softest_direction"].values @ principal.directions[0])
            assert along == pytest.approx(1.0, abs=1e-6)
            np.testing.assert_allclose(of_load["wrench"], load)
    # the wrist is rigid: the critical factor is that of an arm of three joints
    first_three = replace(screws, first=screws.first[:, :3])
    np.testing.assert_allclose(
        of_load["critical_load_factor"], critical_load(first_three, SPRINGS, load), rtol=1e-5
    )


def test_a_finished_map_is_verified_and_not_computed_again(tmp_path: Path) -> None:
    path = tmp_path / "m.zarr"
    write_map(joint_job(9, 8, 7), path, chunk_points=SMALL)
    check = verify_map(path)
    assert check.intact
    assert check.files >= 7 * 2
    again = write_map(joint_job(9, 8, 7), path, chunk_points=SMALL)
    assert again.computed == 0
    victim = max((path / "minimum_stiffness").rglob("0"), key=lambda p: p.is_file())
    data = bytearray(victim.read_bytes())
    data[len(data) // 2] ^= 1
    victim.write_bytes(data)
    assert verify_map(path).damaged == (victim.relative_to(path).as_posix(),)
    victim.unlink()
    assert verify_map(path).missing == (victim.relative_to(path).as_posix(),)


KILLED = """
import sys, time
import numpy as np
from sk120stiff.workspace import store, write_map
from tests.workspace.arms import joint_job
write = store.MapStore.write_chunk
def slowly(self, chunk, **options):
    points = write(self, chunk, **options)
    time.sleep(0.02)
    return points
store.MapStore.write_chunk = slowly
write_map(joint_job(24, 16, 20), sys.argv[1], chunk_points=300)
"""


@pytest.mark.parametrize("seed", range(3))
def test_a_killed_run_loses_at_most_the_chunk_it_was_at(tmp_path: Path, seed: int) -> None:
    job, path = joint_job(24, 16, 20), tmp_path / "m.zarr"
    number = MapStore(path, job, SMALL).chunks.number
    root = Path(__file__).resolve().parents[2]
    process = subprocess.Popen([sys.executable, "-c", KILLED, str(path)], cwd=root)
    progress = path / store_module.PROGRESS
    wanted = 2 + 5 * seed
    deadline = time.monotonic() + 120
    while len(list(progress.glob("*.json"))) < wanted and time.monotonic() < deadline:
        time.sleep(0.003)
    time.sleep(0.007 * seed)
    process.send_signal(signal.SIGKILL)
    assert process.wait() == -signal.SIGKILL
    finished = len(list(progress.glob("*.json")))
    assert wanted <= finished < number
    with pytest.raises(InputError, match="no finished map"):
        open_map(path)
    report = write_map(job, path, chunk_points=SMALL)
    per_chunk = job.points.grid.size / number
    assert report.computed <= (number - finished) * per_chunk + per_chunk
    assert report.computed >= (number - finished - 1) * per_chunk
    assert verify_map(path).intact
    assert not progress.exists()
    whole = tmp_path / "whole.zarr"
    write_map(job, whole, chunk_points=SMALL)
    assert contents(path) == contents(whole)
    assert [entry.name for entry in sorted(tmp_path.iterdir())] == ["m.zarr", "whole.zarr"]
    assert not list(path.rglob("*.partial"))


def test_a_half_written_chunk_and_a_half_written_record_are_done_again(tmp_path: Path) -> None:
    job, path = joint_job(24, 16), tmp_path / "m.zarr"
    store = MapStore(path, job, SMALL)
    assert store.prepare().done == frozenset()
    store.write_chunk(0)
    store.write_chunk(1)
    (path / store_module.PROGRESS / "1.json").write_text('{"points": 25')
    assert store.prepare().done == {0}
    record = json.loads((path / store_module.PROGRESS / "0.json").read_text())
    (path / next(iter(record["files"]))).unlink()
    assert store.prepare().done == frozenset()
    with pytest.raises(Refusal, match="chunk 0"):
        store.finish()


def test_another_map_in_the_place_is_not_touched(tmp_path: Path) -> None:
    path = tmp_path / "m.zarr"
    write_map(joint_job(4, 4), path)
    with pytest.raises(InputError, match="another map"):
        write_map(joint_job(4, 5), path)
    write_map(joint_job(4, 5), path, overwrite=True)
    assert open_map(path).sizes["joint_3_u"] == 5
    mine = tmp_path / "letters"
    mine.mkdir()
    (mine / "dear.txt").write_text("keep me")
    with pytest.raises(InputError, match="no map"):
        write_map(joint_job(4, 4), mine)
    with pytest.raises(InputError, match="not overwritten"):
        write_map(joint_job(4, 4), mine, overwrite=True)
    assert (mine / "dear.txt").read_text() == "keep me"


def test_a_grid_too_large_for_the_disk_is_told_before_it_starts(tmp_path: Path) -> None:
    job = joint_job(100_000, 100_000, 10_000)
    with pytest.raises(InputError, match="GB are free"):
        write_map(job, tmp_path / "m.zarr", chunk_points=SMALL)
    assert not (tmp_path / "m.zarr").exists()


def test_a_disk_that_fills_up_is_told_and_the_run_goes_on_later(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    job, path = joint_job(24, 16, 5), tmp_path / "m.zarr"
    real, calls = store_module.sha256_of, []

    def full(file: Path) -> str:
        calls.append(file)
        if len(calls) > 20:
            raise OSError(errno.ENOSPC, "No space left on device")
        return real(file)

    monkeypatch.setattr(store_module, "sha256_of", full)
    with pytest.raises(Refusal, match="disk is full"):
        write_map(job, path, chunk_points=SMALL)
    monkeypatch.setattr(store_module, "sha256_of", real)
    report = write_map(job, path, chunk_points=SMALL)
    assert 0 < report.computed < report.points
    assert verify_map(path).intact


def test_positions_are_reached_or_told_why_not(tmp_path: Path) -> None:
    axes = (
        Axis("x", np.array([0.2, 1.6, 2.0])),
        Axis("y", np.array([-0.5, 0.0])),
        Axis("z", np.array([-2.4, 0.3, 4.0])),
    )
    down = np.array([0.0, 0.0, -1.0])
    job = MapJob(sk120(), PositionGrid(Grid(axes), np.zeros(6), axis=down), LOADS)
    path = tmp_path / "m.zarr"
    write_map(job, path, chunk_points=SMALL)
    dataset = open_map(path).load()
    status = dataset["status"].values
    assert (status[:, :, 2] == STATUS.index("out of reach")).all()
    assert (status[1, :, 1] == STATUS.index("reached")).all()
    reached = status == STATUS.index("reached")
    where = sk120().kinematics(dataset["joints"].values[reached])
    corners = np.stack(np.meshgrid(*(axis.values for axis in axes), indexing="ij"), axis=-1)
    np.testing.assert_allclose(where.position, corners[reached], atol=1e-8)
    np.testing.assert_allclose(
        where.rotation[:, :, 2], np.tile(down, (reached.sum(), 1)), atol=1e-8
    )
    stiffness = dataset["minimum_stiffness"].values
    assert (np.isfinite(stiffness) == reached).all()
    assert (dataset["stability"].values[:, ~reached] == 255).all()
    summary, counts = summarise_map(path)
    assert sum(counts.values()) == 18
    assert counts["reached"] == reached.sum()
    assert summary[0].softest == stiffness[0][reached].min()


def test_what_is_held_in_memory_is_bounded(tmp_path: Path) -> None:
    """A chunk is held and no more, however large the grid."""
    job = joint_job(24, 16, 20)
    largest: list[int] = []
    compute = MapJob.compute

    def watched(self: MapJob, begin: int, end: int, **options: object) -> object:
        largest.append(end - begin)
        return compute(self, begin, end, **options)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(MapJob, "compute", watched)
        write_map(job, tmp_path / "m.zarr", chunk_points=SMALL)
    assert max(largest) <= SMALL
    assert sum(largest) == job.points.grid.size


def test_a_missing_map_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no finished map"):
        verify_map(tmp_path / "none.zarr")


def test_the_folder_can_be_copied(tmp_path: Path) -> None:
    write_map(joint_job(4, 4), tmp_path / "m.zarr")
    shutil.copytree(tmp_path / "m.zarr", tmp_path / "copy.zarr")
    assert verify_map(tmp_path / "copy.zarr").intact


def test_a_map_needs_no_dask(tmp_path: Path) -> None:
    write_map(joint_job(9, 8, 7), tmp_path / "m.zarr", chunk_points=SMALL)
    program = (
        "import sys; sys.modules['dask'] = None\n"
        "from sk120stiff.workspace import summarise_map\n"
        f"loads, status = summarise_map({str(tmp_path / 'm.zarr')!r})\n"
        "print(sum(status.values()), loads[0].softest)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    points, softest = done.stdout.split()
    loads, _ = summarise_map(tmp_path / "m.zarr")
    assert (int(points), float(softest)) == (9 * 8 * 7, loads[0].softest)
