"""A link's mass lies along it: what a cut carries, against beams in books and sums of slices."""

from __future__ import annotations

import numpy as np
import pytest

from sk120stiff.effects import load_case
from sk120stiff.effects.link_beam import LinkBending
from sk120stiff.model.assembly import Assembly
from sk120stiff.robot import Chain, Robot, VirtualJoint, load_robot

MASS, G, EI = 100.0, 9.80665, 1e5
ARM = """<robot name="one"><link name="base"/>
<link name="beam"><inertial><origin xyz="{centre} 0 0"/><mass value="100"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="tip"/><link name="tool"/>
<joint name="j1" type="revolute"><parent link="base"/><child link="beam"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
<joint name="j2" type="revolute"><parent link="beam"/><child link="tip"/><origin xyz="1 0 0"/>
<axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
<joint name="f" type="fixed"><parent link="tip"/><child link="tool"/></joint></robot>"""


def arm(centre: float = 0.5) -> Robot:
    """A beam of one metre that lies level; its centre of mass at a share of it."""
    return load_robot(ARM.format(centre=centre), base="base", tool="tool")


def sag(robot: Robot, beam: LinkBending) -> tuple[float, float]:
    """Slope [rad] and fall [m] of the beam's end under its own weight, first order."""
    mechanism = Assembly(robot, (beam,)).mechanism
    screws = mechanism.screws(np.zeros((1, mechanism.n)))
    torque = screws.gravity_torques(robot.gravity_in_base)[0, 2:]
    compliance = beam.patterns(load_case(robot, np.zeros(2), np.zeros(6)))[0] / EI
    J = screws.jacobian[0][:, 2:]
    moved = J @ (compliance @ torque)
    return float(moved[4]), float(-moved[2])


def test_a_uniform_beam_sags_as_in_books() -> None:
    """W L^2 / 6 EI and W L^3 / 8 EI (Roark, table 8.1, case 2a)."""
    slope, fall = sag(arm(), LinkBending("beam", taper=0.0))
    assert slope == pytest.approx(MASS * G / (6.0 * EI), rel=1e-9)
    assert fall == pytest.approx(MASS * G / (8.0 * EI), rel=1e-9)


@pytest.mark.parametrize("centre", [0.3, 0.5, 0.7])
@pytest.mark.parametrize("taper", [0.0, 0.3, 0.6])
def test_a_tapered_beam_sags_as_the_sum_of_its_slices(centre: float, taper: float) -> None:
    s = (np.arange(20000) + 0.5) / 20000
    first, last = max(0.0, 2.0 * centre - 1.0), min(1.0, 2.0 * centre)
    begin = np.maximum(s, first)
    beyond = np.clip(last - begin, 0.0, None)
    moment = MASS * G * beyond / (last - first) * (0.5 * (begin + last) - s)
    soft = (1.0 - taper * s) ** -3
    turn = moment * soft / soft.mean() / EI
    slope, fall = sag(arm(centre), LinkBending("beam", taper=taper))
    # Three stations have moments up to the second: the slope of a beam that weighs the same
    # everywhere is exact, where the weight ends halfway it is off by a few per cent.
    assert slope == pytest.approx(turn.mean(), rel=1e-6 if centre == 0.5 else 0.036)
    assert fall == pytest.approx((turn * (1.0 - s)).mean(), rel=0.038)


def test_what_is_cut_adds_up() -> None:
    chain = arm(0.4).mechanism().chain
    cut = cuts(chain, [0.9, 0.0, 0.2, 0.2, 1.0])
    assert cut.masses.sum() == pytest.approx(MASS)
    assert (cut.masses >= 0.0).all()
    q = np.zeros((1, cut.m))
    centres = cut.sweep(q).centres
    assert centres is not None
    assert np.allclose(cut.masses @ centres[0] / MASS, [0.4, 0.0, 0.0])


def test_what_a_joint_carries_does_not_go_by_the_order_of_names() -> None:
    """A bearing at the near end carries the whole link, whatever bends beyond it."""
    chain = arm().mechanism().chain
    for places in ([0.5, 0.0], [0.0, 0.5]):
        cut = cuts(chain, places)
        near = cut.names.index(f"v{places.index(0.0)}")
        assert cut.masses[near:].sum() == pytest.approx(MASS)
        assert cut.masses[near + 1 :].sum() == pytest.approx(0.5 * MASS)


@pytest.mark.parametrize("share", [1e-17, 0.1 + 0.2 - 0.3, 1.0 - 1e-16, 0.7 - 1e-17])
def test_rounding_carries_nothing(share: float) -> None:
    """A mass of rounding is none: physics engines refuse it."""
    for centre in (-0.2, 0.2, 0.85, 1.3):
        cut = cuts(arm(centre).mechanism().chain, [share])
        assert ((cut.masses == 0.0) | (cut.masses > 1e-6)).all()


def cuts(chain: Chain, places: list[float]) -> Chain:
    virtual = []
    for k, share in enumerate(places):
        placement = np.eye(4)
        placement[0, 3] = share
        virtual.append(VirtualJoint(f"v{k}", 0, placement, np.array([0.0, 1.0, 0.0])))
    return chain.with_virtual_joints(virtual, 2)
