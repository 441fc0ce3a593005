from pathlib import Path

import numpy as np
import pytest

from sk120stiff.model import joint_spring_model, write_model
from sk120stiff.workspace import open_map
from tests.cli.conftest import Run
from tests.workspace.test_branch import SPRINGS, UP, other_elbow, ur10

GRID = ("--grid", "joint_2_l=-70:70:35; joint_3_u=-100:0:50 deg")


def test_a_map_is_written_and_summed_up(run: Run, tmp_path: Path) -> None:
    store = str(tmp_path / "m.zarr")
    loads = ("--wrench", "0,0,-490 N", "--wrench", "100,0,0,0,10,0 N, N*m")
    found = run("map", "motoman_sk120", *GRID, *loads, "--out", store, "--json")
    assert found.code == 0, found.stderr
    document = found.document
    assert document["points"] == document["written"] == 15
    assert document["seconds"] > 0.0
    assert document["status"]["reached"] == 15
    assert np.shape(document["wrenches"]) == (2, 6)
    dataset = open_map(store)
    softest = float(dataset["minimum_stiffness"].isel(load=0).min())
    assert document["loads"][0]["softest"] == softest
    again = run("map", "motoman_sk120", *GRID, *loads, "--out", store, "--json")
    assert again.document["written"] == 0


def test_a_page_shows_the_map(run: Run, tmp_path: Path) -> None:
    page = tmp_path / "map.html"
    found = run(
        "map", "motoman_sk120", *GRID, "--out", str(tmp_path / "m.zarr"), "--page", str(page)
    )
    assert found.code == 0, found.stderr
    assert "least stiffness" in page.read_text()


def test_slices_are_drawn_for_every_load_and_pair_of_axes(run: Run, tmp_path: Path) -> None:
    folder = tmp_path / "slices"
    loads = ("--wrench", "0,0,-490 N", "--wrench", "100,0,0 N")
    grid = ("--grid", "joint_2_l=-70:70:35; joint_3_u=-100:0:50; joint_5_b=10 deg")
    store = ("--out", str(tmp_path / "m.zarr"))
    found = run("map", "motoman_sk120", *grid, *loads, *store, "--figures", str(folder), "--json")
    assert found.code == 0, found.stderr
    names = {
        f"load{load}_joint_2_l_joint_3_u_{kind}.{ending}"
        for load in (1, 2)
        for kind in ("stiffness", "definiteness", "deflection")
        for ending in ("svg", "png")
    }
    assert {path.name for path in folder.iterdir()} == names
    assert {Path(path).name for path in found.document["figures"]} == names


def test_a_line_has_no_slice(run: Run, tmp_path: Path) -> None:
    store = tmp_path / "m.zarr"
    found = run(
        "map", "motoman_sk120", "--grid", "joint_2_l=-70:70:35 deg", "--out", str(store),
        "--figures", str(tmp_path / "f"),
    )  # fmt: skip
    assert found.code == 2
    assert "two axes" in found.stderr
    assert not store.exists()


def test_people_see_a_table(run: Run, tmp_path: Path) -> None:
    store = str(tmp_path / "m.zarr")
    found = run("map", "motoman_sk120", "--grid", "x=1.8:2.2:0.2; y=0; z=0:4:2 m", "--out", store)
    assert found.code == 0, found.stderr
    assert "6 points" not in found.stderr
    assert "out of reach" in found.stdout
    assert "softest" in found.stdout
    assert "mm" in found.stdout


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--grid", "joint_2_l=0:1:0.1"), "unit"),
        (("--grid", "elbow=0:1:0.1 rad"), "joint_2_l"),
        (("--grid", "x=0:1:0.1; y=0 m"), "x, y and z"),
        (("--grid", "x=0; y=0; z=0; joint_2_l=0 m"), "m"),
        ((*GRID, "--wrench", "nan,0,0 N"), "nan"),
        ((*GRID, "--wrench", "1,0,0"), "unit"),
        ((*GRID, "--scheduler", "tcp://127.0.0.1:9"), "scheduler"),
        ((*GRID, "--tool-axis", "0,0,-1"), "x, y and z"),
        (("--grid", "x=0; y=0; z=0 m", "--tool-axis", "0,0,0"), "no direction"),
        (("--grid", "x=0; y=0; z=0 m", "--orientation", "0,0 deg"), "not 3"),
        (("--grid", "joint_2_l=0:1:1e-6; joint_3_u=0:1:1e-6 rad"), "GB are free"),
    ],
)
def test_bad_input_ends_with_two_and_a_message(
    run: Run, tmp_path: Path, options: tuple[str, ...], says: str
) -> None:
    found = run("map", "motoman_sk120", *options, "--out", str(tmp_path / "m.zarr"))
    assert found.code == 2, found.stdout
    assert says in found.stderr
    assert "Traceback" not in found.stderr
    assert not (tmp_path / "m.zarr").exists()


def test_a_damaged_map_is_mended_and_that_is_said(run: Run, tmp_path: Path) -> None:
    store = tmp_path / "m.zarr"
    arguments = ("map", "motoman_sk120", *GRID, "--out", str(store))
    assert run(*arguments).code == 0
    victim = next(path for path in (store / "stability" / "c").rglob("*") if path.is_file())
    before = victim.read_bytes()
    victim.write_bytes(before[:-1])
    found = run(*arguments)
    assert found.code == 0
    assert "1 files were not as an earlier run had written them" in found.stdout
    assert "stability" in found.stdout
    assert victim.read_bytes() == before
    (store / "joint_2_l" / "zarr.json").unlink()
    assert run(*arguments, "--json").document["mended"] == ["joint_2_l/zarr.json"]


def test_positions_are_reached_in_the_branch_of_the_start(run: Run, tmp_path: Path) -> None:
    """A UR10 over a table: the elbow stays where the start pose has it, and that is said."""
    robot, model = ur10(), tmp_path / "model.yaml"
    write_model(joint_spring_model(robot, SPRINGS), model)
    x, y, z = 1e3 * robot.placement(UP)[:3, 3]
    grid = f"x={x - 100:.3f}:{x + 100:.3f}:50; y={y:.3f}; z={z:.3f}:{z + 100:.3f}:50 mm"
    axis = ",".join(f"{c:.12f}" for c in robot.placement(UP)[:3, 2])
    arguments = ("map", robot.source, "--tool", "tool0", "--model", str(model), "--grid", grid,
                 f"--tool-axis={axis}", "--json")  # fmt: skip
    for start, up in ((UP, True), (other_elbow(robot), False)):
        pose = ",".join(f"{value:.6f}" for value in np.degrees(start))
        out = tmp_path / f"{up}.zarr"
        found = run(*arguments, f"--start={pose} deg", "--out", str(out))
        assert found.code == 0, found.stderr
        counts = found.document["postures"]
        reached = found.document["status"]["reached"]
        assert reached >= 12
        assert (counts["elbow_up"], counts["elbow_down"]) == ((reached, 0) if up else (0, reached))
        assert ("below the base plane" in found.stderr) == (not up)
        joints = open_map(out)["joints"].values.reshape(-1, 6)
        joints = joints[np.isfinite(joints).all(axis=1)]
        assert (np.sign(joints[:, 2]) == np.sign(start[2])).all()
    refused = run("map", "motoman_sk120", *GRID, "--start", "0,0,0,0,0,0 deg", "--out", str(out))
    assert refused.code == 2
    assert "--start" in refused.stderr


def test_a_map_beyond_reach_says_so_and_can_be_read_again(run, tmp_path) -> None:
    """A chunk in which nothing is reached holds nothing but NaN, and is written all the same."""
    options = ("--grid", "x=8:9:1; y=0; z=0 m", "--out", str(tmp_path / "far.zarr"), "--json")
    for written in (2, 0):
        outcome = run("map", "motoman_sk120", *options)
        assert outcome.code == 0, outcome.stderr
        assert outcome.document["written"] == written
        assert outcome.document["status"]["out of reach"] == 2
        assert outcome.document["loads"][0]["softest"] is None


def test_nothing_in_reach_is_told(run, tmp_path) -> None:
    options = ("--grid", "x=8:9:1; y=0; z=0 m", "--out", str(tmp_path / "far.zarr"))
    said = run("map", "motoman_sk120", *options).stdout
    assert "2 out of reach" in said and "No point was reached" in said
    assert "inf" not in said
