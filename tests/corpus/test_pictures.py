"""Shapes of real arms against yourdfpy, which reads the same files with its own code."""

import warnings

import numpy as np
import pytest
import yourdfpy

from sk120stiff.errors import ToolkitWarning
from sk120stiff.robot import load_robot
from sk120stiff.robot.urdf import resolve
from sk120stiff.robot.visuals import visuals
from tests.corpus.robots import example_urdfs

ARMS = ["kinova.urdf", "so100.urdf", "tiago.urdf", "xarm7.urdf"]  # COLLADA, STL, scaled, mirrored


@pytest.mark.parametrize("name", ARMS)
def test_every_mesh_lies_where_yourdfpy_puts_it(name: str) -> None:
    (path,) = [path for path in example_urdfs() if path.name == name]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ToolkitWarning)
        robot = load_robot(path)
    document = robot.document

    def found(fname: str) -> str:
        return str(resolve(fname, document.path, document.package_folders)[0])

    theirs = yourdfpy.URDF.load(str(path), load_meshes=True, filename_handler=found)
    ends = []
    for shape in visuals(robot):
        if shape.vertices is not None:
            T = robot.placement(np.zeros(robot.n), shape.link) @ shape.T_link_visual
            points = shape.vertices @ T[:3, :3].T + T[:3, 3]
            ends.append([points.min(axis=0), points.max(axis=0)])
    assert len(ends) > 5
    bounds = [np.min(ends, axis=(0, 1)), np.max(ends, axis=(0, 1))]
    start = np.linalg.inv(theirs.get_transform(robot.base_frame))
    corners = np.array(np.meshgrid(*np.transpose(theirs.scene.bounds))).reshape(3, -1).T
    moved = corners @ start[:3, :3].T + start[:3, 3]
    np.testing.assert_allclose(bounds, [moved.min(axis=0), moved.max(axis=0)], atol=1e-9)
