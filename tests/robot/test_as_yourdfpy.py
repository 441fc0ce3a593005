"""A robot handed to yourdfpy stands where it stands here: its kinematics are its own code."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff.robot import as_yourdfpy, load_robot
from tests.corpus.robots import example_urdfs

PATHS = [p for p in example_urdfs() if p.name in {"panda.urdf", "tiago.urdf", "kinova.urdf"}]


@pytest.mark.parametrize("source", ["motoman_sk120", "ur5e"])
def test_every_frame_lies_where_it_lies_here(source: str) -> None:
    check(source)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("path", PATHS, ids=lambda p: p.stem)
def test_so_do_those_of_public_arms(path: Path) -> None:
    check(path)


def check(source: str | Path) -> None:
    robot = load_robot(source)
    rng = np.random.default_rng(4)
    a = rng.uniform(-0.4, 0.4, robot.n)
    held = as_yourdfpy(robot, a)
    for frame in [link.name for link in robot.document.links]:
        theirs = held.get_transform(frame, robot.document.root)
        ours = np.linalg.inv(robot.placement(a, robot.document.root)) @ robot.placement(a, frame)
        np.testing.assert_allclose(theirs, ours, atol=1e-9)


def test_masses_travel_too() -> None:
    robot = load_robot("ur5e")
    held = as_yourdfpy(robot)
    assert sum(link.inertial.mass for link in held.robot.links if link.inertial) == robot.total_mass


@pytest.mark.filterwarnings("ignore")
def test_a_mesh_that_is_missing_costs_its_own_shape(tmp_path: Path) -> None:
    text = """<robot name="r"><link name="base"><visual><geometry><box size="1 2 3"/></geometry>
      </visual></link><link name="tip"><visual><geometry><mesh filename="gone.stl"/></geometry>
      </visual><visual><geometry><sphere radius="0.1"/></geometry></visual></link>
      <joint name="j" type="revolute"><parent link="base"/><child link="tip"/>
      <limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""
    (tmp_path / "arm.urdf").write_text(text)
    held = as_yourdfpy(load_robot(tmp_path / "arm.urdf"), meshes=True)
    assert len(held.scene.geometry) == 2
