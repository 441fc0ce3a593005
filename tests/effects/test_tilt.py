"""Bearings that tilt, by every law: against moments and levers in Pinocchio's frames."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray

from sk120stiff import Model, load_robot
from sk120stiff.effects import effect, load_case
from sk120stiff.effects.foundation import BaseRocking
from sk120stiff.effects.joint_tilt import HOUSING, ROLL, JointTilt
from sk120stiff.effects.options import Options
from sk120stiff.errors import InputError
from sk120stiff.robot import Robot
from tests.effects.arms import FOLDER

Array = NDArray[np.float64]

POINT = np.array([0.03, -0.05, 0.11])
WRENCH = np.array([[20.0, -35.0, 50.0, 3.0, 2.0, -4.0]])
TIPS = {"six_axis": ("base_link", "tool0"), "telescope": ("floor", "plate")}


@pytest.fixture(params=TIPS)
def robot(request: pytest.FixtureRequest) -> Robot:
    base, tool = TIPS[request.param]
    return load_robot(FOLDER / f"{request.param}.urdf", base=base, tool=tool)


class Frames:
    """Where Pinocchio has the joints of an arm at a pose, in axes of its base."""

    def __init__(self, robot: Robot, a: Array) -> None:
        self.model = pin.buildModelFromUrdf(robot.source)
        self.data = self.model.createData()
        q = pin.neutral(self.model)
        for name, value in zip(robot.actuated, a, strict=True):
            q[self.model.joints[self.model.getJointId(name)].idx_q] = value
        pin.framesForwardKinematics(self.model, self.data, q)

    def joint(self, name: str) -> tuple[Array, Array]:
        """Origin and rotation of the frame that a joint moves."""
        found = self.data.oMi[self.model.getJointId(name)]
        return found.translation.copy(), found.rotation.copy()

    def tip(self, frame: str) -> Array:
        found = self.data.oMf[self.model.getFrameId(frame)]
        return np.asarray(found.translation + found.rotation @ POINT)


def normal_to(axis: Array, along: Array) -> tuple[Array, Array]:
    flat = along - axis * (axis @ along)
    flat = flat / np.linalg.norm(flat)
    return flat, np.cross(axis, flat)


LAWS = {
    "plain": ("stiffness_along", "stiffness_across"),
    "askew": ("stiffness_along", "stiffness_across", "cross_stiffness"),
    "housing": tuple(f"{n}{HOUSING}" for n in ("stiffness_along", "stiffness_across",
                                               "cross_stiffness")),
    "rolls": ("stiffness_along", "stiffness_across", ROLL),
}  # fmt: skip
CASES = [
    *(("six_axis", law, place) for law in ("plain", "askew") for place in ("lift", "elbow")),
    *(("six_axis", "housing", place) for place in ("elbow", "wrist_1")),
    *(("telescope", law, "extend") for law in ("plain", "askew", "rolls")),
]
BEFORE = {"wrist_1": "elbow", "elbow": "lift", "extend": "pitch"}
BEHIND = {"wrist_1": "wrist_2", "lift": "elbow", "elbow": "wrist_1", "extend": "roll"}


@pytest.mark.parametrize(("arm", "law", "place"), CASES)
def test_the_tool_moves_as_moments_and_levers_say(arm: str, law: str, place: str) -> None:
    base, tool = TIPS[arm]
    robot = load_robot(FOLDER / f"{arm}.urdf", base=base, tool=tool)
    a = np.array([0.4, -1.1, 0.8, 0.3, -0.7, 0.2])
    if arm == "telescope":
        a = np.array([0.4, 0.3, 0.5, 0.3, -0.7, 0.2])
    found = JointTilt.at(robot, place, Options(shape=LAWS[law]))
    c = np.array([3e-7, 1e-7, 2e-7 if law == "rolls" else -1.2e-7])[: len(found.parameters)]
    model = Model(robot) + found
    moved = model.predict(load_case(robot, a, WRENCH, point=POINT, force_point=POINT), c)[0]

    frames = Frames(robot, a)
    origin, own = frames.joint(place)
    axis = own @ robot.document.by_name[place].axis
    link = frames.joint(BEHIND[place])[0] - origin  # the link that the joint moves
    if law == "housing":
        link = origin - frames.joint(BEFORE[place])[0]  # the one on which it sits
    axes = np.array([*normal_to(axis, link), axis])[: 3 if law == "rolls" else 2]
    C = np.diag(c[: len(axes)])
    if law in ("askew", "housing"):
        C[0, 1] = C[1, 0] = c[2]
    lever = frames.tip(tool) - origin
    moment = WRENCH[0, 3:] + np.cross(lever, WRENCH[0, :3])
    turn = axes.T @ (C @ (axes @ moment))
    assert np.linalg.norm(turn) > 1e-6
    np.testing.assert_allclose(moved, np.cross(turn, lever), rtol=2e-4, atol=2e-9)


def test_a_housing_on_the_base_has_the_axes_of_the_base() -> None:
    base, tool = TIPS["six_axis"]
    robot = load_robot(FOLDER / "six_axis.urdf", base=base, tool=tool)
    housing = JointTilt.at(robot, "pan", Options(shape=LAWS["housing"]))
    along, across = housing.virtual_joints(robot)
    np.testing.assert_allclose([along.axis, across.axis], np.eye(3)[:2], atol=1e-12)
    assert along.placement[2, 3] == pytest.approx(Frames(robot, np.zeros(6)).joint("pan")[0][2])


def test_each_kind_of_joint_has_its_own_other_laws(robot: Robot) -> None:
    for place in JointTilt.places(robot):
        usual = effect(robot, "joint_tilt", place)
        cases = load_case(robot, np.zeros(6) + 0.2, WRENCH)
        names = {p.name for law in usual.other_laws(cases) for p in law.parameters}
        slides = dict(zip(robot.actuated, robot.prismatic, strict=True))[place]
        assert (ROLL in names) == slides
        near = place == "pan"  # 0.13 m over the base, of an arm of 1.6 m: the base that rocks
        assert (f"stiffness_along{HOUSING}" in names) == (not slides and not near)
        assert "cross_stiffness" in names


def test_a_joint_that_turns_does_not_roll() -> None:
    base, tool = TIPS["six_axis"]
    robot = load_robot(FOLDER / "six_axis.urdf", base=base, tool=tool)
    with pytest.raises(InputError, match="lift does not slide"):
        JointTilt.at(robot, "lift", Options(shape=(ROLL,)))


def test_words_say_about_which_axis_a_part_is_softest() -> None:
    """Principal axes of a compliance that was turned by 40 degrees."""
    soft, stiff, turn = 1 / 2e6, 1 / 8e6, np.radians(40.0)
    u = np.array([np.cos(turn), np.sin(turn)])
    C = stiff * np.eye(2) + (soft - stiff) * np.outer(u, u)
    values = [1.0 / C[0, 0], 1.0 / C[1, 1], 1.0 / C[0, 1]]
    bearing = JointTilt("lift", askew=True, housing=True)
    said = bearing.told({p.name: v for p, v in zip(bearing.parameters, values, strict=True)})
    assert "softest, 2e+06 N*m/rad, about an axis 40 deg from the direction" in said
    assert "8e+06 N*m/rad about the one across, whatever the joint's angle" in said
    base = BaseRocking("floor", askew=True, below=0.8)
    said = base.told({p.name: v for p, v in zip(base.parameters, values, strict=True)})
    assert said.startswith("The base rocks on its foundation about a point 0.8 m below: softest")
    assert "40 deg from x towards y" in said
    rigid = base.told({p.name: np.inf for p in base.parameters})
    assert rigid == "The base rocks on its foundation about a point 0.8 m below."
