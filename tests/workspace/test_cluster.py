"""Maps on a Dask cluster of real processes."""

import os
import signal
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from sk120stiff.errors import InputError
from sk120stiff.workspace import open_map, verify_map, write_map
from sk120stiff.workspace import store as store_module
from tests.workspace.arms import joint_job

dask, distributed = pytest.importorskip("dask"), pytest.importorskip("distributed")


@pytest.fixture(scope="module")
def cluster():
    """One for all: a worker that is killed comes back."""
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as running:
        yield running


def test_a_cluster_writes_the_same_map(cluster, tmp_path: Path) -> None:
    job = joint_job(30, 30, 20)
    done: list[tuple[int, int]] = []
    report = write_map(
        job,
        tmp_path / "cluster.zarr",
        scheduler=cluster.scheduler_address,
        progress=lambda now, total: done.append((now, total)),
    )
    assert report.computed == job.points.grid.size
    assert done[-1] == (job.points.grid.size,) * 2
    write_map(job, tmp_path / "here.zarr")
    here = open_map(tmp_path / "here.zarr")
    for name, array in open_map(tmp_path / "cluster.zarr").items():
        np.testing.assert_array_equal(array, here[name])


def test_a_lost_worker_costs_time_only(cluster, tmp_path: Path) -> None:
    job, path = joint_job(40, 40, 30), tmp_path / "m.zarr"
    progress = path / store_module.PROGRESS
    killed: list[int] = []

    def kill_one() -> None:
        deadline = time.monotonic() + 60
        while len(list(progress.glob("*.json"))) < 3 and time.monotonic() < deadline:
            time.sleep(0.005)
        victim = next(iter(cluster.workers.values()))
        os.kill(victim.pid, signal.SIGKILL)
        killed.append(victim.pid)

    killer = threading.Thread(target=kill_one)
    killer.start()
    report = write_map(job, path, scheduler=cluster.scheduler_address, chunk_points=2048)
    killer.join()
    assert killed
    assert report.points == job.points.grid.size
    assert verify_map(path).intact
    write_map(job, tmp_path / "whole.zarr")
    whole = open_map(tmp_path / "whole.zarr")
    for name, array in open_map(path).items():
        np.testing.assert_array_equal(array, whole[name])


def test_a_scheduler_that_is_not_there_is_told_in_seconds(tmp_path: Path) -> None:
    begin = time.monotonic()
    with pytest.raises(InputError, match="no Dask scheduler"):
        write_map(joint_job(4, 4), tmp_path / "m.zarr", scheduler="tcp://127.0.0.1:9")
    with pytest.raises(InputError, match="no Dask scheduler"):
        write_map(joint_job(4, 4), tmp_path / "m.zarr", scheduler="not an address")
    assert time.monotonic() - begin < 20
    assert not (tmp_path / "m.zarr").exists()
    write_map(joint_job(4, 4), tmp_path / "m.zarr")
    assert dask.config.get("scheduler", None) is None  # what is read here is computed here
    assert np.isfinite(open_map(tmp_path / "m.zarr")["minimum_stiffness"].values).any()
