"""Laws that are right in kind and wrong in detail, against closed forms, work and an engine."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.hidden.generator.causes_curves import (
    Dahl,
    MaxwellSlip,
    PowerHardening,
    SmoothPlay,
    SteppedHardening,
)
from tests.hidden.generator.causes_detail import RealBeam, TurnedRocking, WarmUp
from tests.hidden.generator.causes_elastic import LinkBending
from tests.hidden.generator.design import plan
from tests.hidden.generator.history import History
from tests.hidden.generator.robots import varied
from tests.hidden.generator.rotations import Array
from tests.hidden.generator.rows import Rows
from tests.hidden.generator.sk120 import sk120
from tests.hidden.generator.world import Cause, World
from tests.hidden.test_generator import cantilever

STIFFNESS = 2e5  # [N m / rad]
SLIP = MaxwellSlip(
    "j", {"half_width": 3e-4}, {"shares": (0.5, 0.3, 0.2), "reach": (2e-4, 5e-4, 9e-4)}
)
DAHL = Dahl("j", {"half_width": 3e-4}, {"reach": 2e-4})


def run(cause: Any, torques: Array) -> Array:
    """Twists under torques that come one after the other."""
    advance, state, out = cause.advance(STIFFNESS), None, []
    for torque in torques:
        twist, state = advance(state, np.array([torque]))
        out.append(twist[0])
    return np.array(out)


def test_first_loading_of_sliders_is_their_sum() -> None:
    torques = np.linspace(0.0, 400.0, 41)
    twist = run(SLIP, torques)
    limit = 3e-4 * STIFFNESS * np.array([0.5, 0.3, 0.2])
    reach = np.array([2e-4, 5e-4, 9e-4])
    forces = STIFFNESS * twist + (limit * np.minimum(twist[:, None] / reach, 1.0)).sum(1)
    assert np.allclose(forces, torques, rtol=1e-12)
    # beyond all reaches the whole friction is taken off
    assert twist[-1] == pytest.approx((400.0 - limit.sum()) / STIFFNESS, rel=1e-12)


@pytest.mark.parametrize("cause", [SLIP, DAHL])
def test_branches_of_a_loop_are_the_first_loading_twice_as_large(cause: Any) -> None:
    """Masing's rule; Dahl's law obeys it in the friction that goes all the way."""
    first = np.linspace(0.0, 400.0, 21)
    up = run(cause, first)
    down = run(cause, np.concatenate([first, 400.0 - 2.0 * first]))[21:]
    if cause is SLIP:
        assert np.allclose(up[-1] - down, 2.0 * up, rtol=1e-10, atol=1e-15)
    else:
        limit, reach = 3e-4 * STIFFNESS, 2e-4
        assert np.allclose(
            STIFFNESS * up + limit * (1.0 - np.exp(-up / reach)), first, rtol=1e-11, atol=1e-9
        )
        way = up[-1] - down
        top = limit * (1.0 - np.exp(-up[-1] / reach))
        friction = -limit + (top + limit) * np.exp(-way / reach)
        assert np.allclose(STIFFNESS * down + friction, 400.0 - 2.0 * first, atol=1e-9)


@pytest.mark.parametrize("cause", [SLIP, DAHL])
def test_work_of_a_loop_is_what_friction_takes(cause: Any) -> None:
    top, count = 400.0, 1201
    there, back = np.linspace(-top, top, count), np.linspace(top, -top, count)
    cycle = np.concatenate([there, back, there, back, there])
    twist = run(cause, cycle)
    loop = slice(3 * count - 1, None)
    work = np.trapezoid(cycle[loop], twist[loop])
    if cause is SLIP:
        limit = 3e-4 * STIFFNESS * np.array([0.5, 0.3, 0.2])
        reach = np.array([2e-4, 5e-4, 9e-4])
        taken = (4.0 * limit * np.maximum(twist.max() - reach, 0.0)).sum()
    else:
        # one way of 2X from -F1 to F1: the integral of F over it, twice
        limit, way = 3e-4 * STIFFNESS, 2.0 * twist.max()
        fade = 1.0 - np.exp(-way / 2e-4)
        end = limit * fade / (2.0 - fade)
        taken = 2.0 * (limit * way - (limit + end) * 2e-4 * fade)
    assert work == pytest.approx(taken, rel=2e-5)


def test_stiff_sliders_are_plain_friction() -> None:
    """With no reach the twist lags by the half width, on both branches."""
    stiff = replace(SLIP, options={"shares": (1.0,), "reach": (1e-12,)})
    twist = run(stiff, np.array([0.0, 200.0, 400.0, 200.0, -200.0]))
    lag = 3e-4 * np.array([0.0, -1.0, -1.0, 1.0, 1.0])
    plain = np.array([0.0, 200.0, 400.0, 200.0, -200.0]) / STIFFNESS
    assert np.allclose(twist[[1, 2, 4]], (plain + lag)[[1, 2, 4]], atol=1e-10)
    assert plain[3] < twist[3] <= twist[2] + 1e-15  # it sticks until the torque has turned


def test_history_follows_order_zeros_and_repeats() -> None:
    flat = np.zeros(4)
    rows = Rows(np.array([7, 7, 7, 9]), {"j": flat}, np.zeros((4, 3)), np.zeros((4, 3)),
                np.array([1.0, 2.0, 5.0, 8.0]), np.array([0.0, 0.0, 4.0, 7.0]), np.ones(4),
                np.array([1, 2, 1, 1]), np.zeros(3), np.zeros(3))  # fmt: skip
    history = History.of(rows)
    # zero, first, taken off, again, another zero, last
    assert history.steps[:, 0].tolist() == [-1, 0, -1, 1, -1, 2]
    assert history.steps[:2, 1].tolist() == [-1, 3]
    assert history.zero.tolist() == [0, 0, 4, 0]

    def count(state: float | None, torque: Array) -> tuple[Array, float]:
        state = (0.0 if state is None else state) + 1.0
        return torque + state, state

    seen = history.walk(np.array([10.0, 20.0, 30.0, 40.0]), count)
    assert seen.tolist() == [11.0, 23.0, 31.0, 41.0]  # what came since the row's own zero


@pytest.mark.parametrize(
    ("cause", "slope"),
    [
        (SmoothPlay("j", {"half_width": 2e-4}, {"flank": 50.0, "skew": 0.4}),
         lambda t: 2e-4 / 50.0 / np.cosh(t / (50.0 * (1.4 if t > 0 else 0.6))) ** 2),
        (SteppedHardening("j", {"share": 0.5}, {"knees": (40.0, 120.0), "shares": (1.0, 0.4)}),
         lambda t: 0.5 / STIFFNESS * (1.0 if abs(t) < 40 else 0.4 if abs(t) < 120 else 0.0)),
        (PowerHardening("j", {"share": 0.3}, {"exponent": 0.7, "full": 300.0}),
         lambda t: 0.3 / STIFFNESS * 0.7 * abs(t / 300.0) ** -0.3),
    ],
)  # fmt: skip
def test_curves_have_the_slopes_that_they_state(cause: Any, slope: Any) -> None:
    for torque in (-210.0, -70.0, -20.0, 15.0, 55.0, 160.0):
        step = 1e-4
        ends = cause.curve(np.array([torque + step, torque - step]), 1.0 / STIFFNESS)
        assert (ends[0] - ends[1]) / (2 * step) == pytest.approx(slope(torque), rel=1e-6, abs=1e-18)
    assert cause.curve(np.zeros(1), 1.0 / STIFFNESS) == 0.0


def test_unequal_flanks_close_at_their_own_widths() -> None:
    cause = SmoothPlay("j", {"half_width": 2e-4}, {"flank": 10.0, "skew": 0.5})
    ends = cause.curve(np.array([-1e4, 1e4]), 1.0 / STIFFNESS)
    assert ends == pytest.approx([-1e-4, 3e-4])


def world_rows(schedule: str = "up_down", poses: int = 5) -> tuple[World, Rows]:
    arm = sk120()
    rows = plan(arm, np.random.default_rng(1), poses=poses, loads=3, schedule=schedule)
    return World(arm, varied(arm, np.random.default_rng(3))), rows


@pytest.mark.parametrize(
    "cause",
    [
        SmoothPlay("joint_2_l", {"half_width": 2e-4}, {"flank": 80.0, "skew": -0.3}),
        SteppedHardening("joint_2_l", {"share": 0.5},
                         {"knees": (90.0, 250.0, 400.0), "shares": (1.0, 0.5, 0.1)}),
        RealBeam("link_2_l", {"flexibility": 2e-7},
                 {"taper": 0.6, "steps": ((0.5, 3.0),), "ratio": 1.5,
                  "pieces": 6}),
        TurnedRocking("base_link", {"soft": 3e-7, "stiff": 6e-8}, {"turn": 0.7}),
    ],
)  # fmt: skip
def test_reversible_laws_give_back_their_work(cause: Cause) -> None:
    """What a load does on the way there it gets back on any way home: no loop, no lost work."""
    plain, rows = world_rows()
    rows = rows.pick(np.arange(0, rows.count, 5))
    world = plain.with_causes(cause)
    side = np.cross(rows.force, [0.3, -0.5, 0.8])
    nodes, weights = np.polynomial.legendre.leggauss(40 if hasattr(cause, "curve") else 8)

    def work(start: Array, end: Array) -> Array:
        done = np.zeros(rows.count)
        for share, weight in zip(0.5 * (nodes + 1.0), weights, strict=True):
            at = world.displacement(replace(rows, force=start + share * (end - start)))
            done += 0.5 * weight * np.einsum("ni,ni->n", at, end - start)
        return done

    zero = 0.0 * side
    around = work(zero, rows.force) + work(rows.force, side) + work(side, zero)
    scale = np.abs(work(zero, rows.force)).max()
    assert np.abs(around).max() < 2e-4 * scale
    change = world.displacement(rows) - plain.displacement(rows)
    assert np.abs(change).max() > 1e-6


@pytest.mark.parametrize(
    "cause", [replace(SLIP, where="joint_2_l"), replace(DAHL, where="joint_2_l")]
)
def test_arm_lags_on_the_way_down(cause: Any) -> None:
    world, rows = world_rows()
    change = world.with_causes(cause).displacement(rows) - world.displacement(rows)
    along = np.einsum("ni,ni->n", change, rows.force)
    assert np.all(along[rows.branch > 0] < 0.0)
    same = {(p, round(float(np.linalg.norm(f)))): a
            for p, f, a in zip(rows.pose, rows.force, along, strict=True)}  # fmt: skip
    for row in np.nonzero(rows.branch > 0)[0]:
        key = (rows.pose[row], round(float(np.linalg.norm(rows.force[row]))))
        assert along[row] <= same[key] + 1e-15  # the last reading of a load is on the way down


def test_stepped_beam_bends_as_its_integral_says() -> None:
    arm, rows = cantilever(1.3)
    s = (np.arange(240000) + 0.5) / 240000
    local = (1.0 - 0.6 * s) ** -3.0 * np.where(s >= 0.5, 3.0, 1.0)
    local /= local.mean()
    unit = 1.3**3 * np.mean(local * (1.0 - s) ** 2) / 6e6
    beam = RealBeam("l0", {"flexibility": 1 / 6e6},
                    {"taper": 0.6, "steps": ((0.5, 3.0),), "ratio": 2.0, "pieces": 60})  # fmt: skip
    d = World(arm, {}, (beam,)).displacement(rows)
    sides = sorted([d[0, 2] / (-50 * unit), d[1, 1] / (30 * unit)])
    assert sides == pytest.approx([1.0, 2.0], rel=1e-3)
    plain = World(arm, {}, (RealBeam("l0", {"flexibility": 1e-7}, {"pieces": 20}),))
    twin = World(arm, {}, (LinkBending("l0", {"flexibility": 1e-7}),))
    assert np.allclose(plain.displacement(rows), twin.displacement(rows), rtol=1e-12)


def test_forearm_beam_lies_around_its_roll_axis() -> None:
    arm = sk120()
    beam = RealBeam("link_3_u", {"flexibility": 1e-7}, {"tube": True})
    axis = arm.shafts()["link_3_u"][2]
    axis = axis / np.linalg.norm(axis)
    assert max(abs(insert.axis @ axis) for insert in beam.inserts(arm)) < 1e-12
    straight = arm.spans()["link_3_u"][1]
    angle = np.degrees(np.arccos(axis @ straight / np.linalg.norm(straight)))
    assert angle == pytest.approx(9.3, abs=2.0)


def test_turned_rocking_is_a_turned_compliance() -> None:
    arm, rows = cantilever(1.3)
    turn, soft, stiff = 0.7, 3e-7, 5e-8
    world = World(arm, {}, (TurnedRocking("base", {"soft": soft, "stiff": stiff}, {"turn": turn}),))
    spin = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    c = spin @ np.diag([soft, stiff, 0.0]) @ spin.T
    lever = np.array([1.3, 0.0, 0.0])
    expected = np.cross(np.cross(lever, rows.force) @ c, lever)
    assert np.allclose(world.displacement(rows), expected, rtol=0, atol=1e-8 * 1.3)
    assert np.abs(expected).max() > 1e-6


def test_warm_up_ends() -> None:
    world, rows = world_rows("ascending", poses=20)
    cause = WarmUp("tracker", {"x": 2e-6, "z": -1e-6}, {"time": 15.0})
    change = world.with_causes(cause).displacement(rows) - world.displacement(rows)
    whole = 15.0 * np.array([2e-6, 0.0, -1e-6])
    first = np.exp(-rows.zero_order[0] / 15.0) - np.exp(-rows.order[0] / 15.0)
    assert np.allclose(change[0], first * whole, atol=1e-17)
    assert np.abs(change[rows.order > 72]).max() < 0.02 * np.abs(change).max()
