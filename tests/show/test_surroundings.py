"""What stands around the arm is drawn where the cell says that it is."""

import numpy as np
import pytest

from sk120stiff import load_robot
from sk120stiff.plan import Cell, read_cell
from sk120stiff.show.scene.links import link_tree
from sk120stiff.show.scene.surroundings import OBSTACLE, surroundings_of
from tests.show.scenes import walled_cell

CELL = """
floor: -0.8 m
obstacles:
  - {name: wall, box: [100, 3000, 2000], xyz: [-1500, 0, 200], unit: mm}
  - {name: post, cylinder: [0.1, 1.5], xyz: [0.5, 1.8, 0]}
  - {name: behind, plane: [0, 1, 0], xyz: [0, -2, 0]}
tool:
  - {name: plate, box: [0.3, 0.3, 0.03], xyz: [0, 0, 0.05]}
tracker: {xyz: [3, -2, 0.5]}
"""


@pytest.fixture(scope="module")
def robot():
    return load_robot("motoman_sk120")


def test_every_kind_of_solid_has_its_shape_its_place_and_its_link(robot, tmp_path):
    (tmp_path / "cell.yaml").write_text(CELL, encoding="utf-8")
    tree = link_tree(robot)
    cell = read_cell(tmp_path / "cell.yaml", robot)
    wall, post, behind, plate, floor, tracker = surroundings_of(cell, robot, tree)
    assert [body.kind for body in (wall, post, behind, plate, floor, tracker)] == [
        "box", "cylinder", "box", "box", "box", "sphere",
    ]  # fmt: skip
    assert all(body.still for body in (wall, post, behind, plate, floor, tracker))
    assert [tree.names[body.link] for body in (wall, plate)] == [
        robot.base_frame,
        robot.tool_frame,
    ]
    np.testing.assert_allclose(wall.size, (0.1, 3.0, 2.0))
    np.testing.assert_allclose(wall.placement[:3, 3], (-1.5, 0.0, 0.2))
    assert post.size == (0.1, 1.5)
    np.testing.assert_allclose(tracker.placement[:3, 3], (3.0, -2.0, 0.5))
    for slab, top, away in ((floor, (0, 0, -0.8), (0, 0, 1)), (behind, (0, -2, 0), (0, 1, 0))):
        np.testing.assert_allclose(slab.placement[:3, 2], away, atol=1e-12)
        upper = slab.placement[:3, 3] + 0.5 * slab.size[2] * slab.placement[:3, 2]
        np.testing.assert_allclose(upper, top, atol=1e-12)


def test_a_mesh_is_drawn_as_the_hull_that_was_checked(robot):
    (body,) = surroundings_of(walled_cell(hull=True), robot, link_tree(robot))
    corners = body.mesh.vertices[body.mesh.faces]
    area = 0.5 * np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    assert (body.kind, body.colour) == ("mesh", OBSTACLE)
    assert area.sum() == pytest.approx(2 * (0.1 * 3.0 + 3.0 * 5.0 + 5.0 * 0.1))


def test_a_cell_that_states_nothing_has_nothing_to_show(robot):
    assert surroundings_of(Cell(), robot, link_tree(robot)) == ()
