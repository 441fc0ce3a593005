"""L10, L12 and the other plans of measuring: what the generator promises of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import least_squares

from tests.hidden.families import family
from tests.hidden.generator.build import BUILDERS, build
from tests.hidden.generator.case import Case
from tests.hidden.generator.causes_elastic import BaseRocking
from tests.hidden.generator.causes_foreign import RubberMount
from tests.hidden.generator.design import plan
from tests.hidden.generator.draw import choices, unit_causes
from tests.hidden.generator.draw_real import real
from tests.hidden.generator.levels import setting, shows
from tests.hidden.generator.levels_real import lifelike_pool, remainder
from tests.hidden.generator.noise import Noise
from tests.hidden.generator.plans import told, tracker
from tests.hidden.generator.robots import six_axis, varied
from tests.hidden.generator.signature import blocks, view
from tests.hidden.generator.sk120 import sk120
from tests.hidden.generator.world import World
from tests.hidden.generator.writing import description


def test_new_levels_leave_the_seeds_of_old_ones() -> None:
    assert list(BUILDERS)[:10] == [f"L{number}" for number in range(10)]


@pytest.mark.parametrize(
    ("schedule", "loads", "rows"),
    [("single", 1, 1), ("three_axes", 3, 3), ("ladder", 3, 10), ("reloads", 4, 8)],
)
def test_schedules_load_as_they_say(schedule: str, loads: int, rows: int) -> None:
    arm = sk120()
    found = plan(arm, np.random.default_rng(1), poses=6, loads=loads, schedule=schedule)
    assert found.count == 6 * rows
    size = np.linalg.norm(found.force, axis=1)
    assert np.all(size > 0.2 * arm.typical.force)
    first = found.pick(np.nonzero(found.pose == 1)[0])
    if schedule == "three_axes":
        assert np.array_equal(np.abs(first.force) > 0.0, np.eye(3, dtype=bool))
    if schedule == "ladder":
        along = first.force @ first.force[0] / np.linalg.norm(first.force[0])
        steps = along / along.max() * 3.0
        assert steps == pytest.approx([1, 2, 3, 2, 1, -1, -2, -3, -2, -1])
        assert first.branch.tolist() == [1, 1, 1, -1, -1] * 2
    if schedule == "reloads":
        assert np.array_equal(first.force[:4], first.force[4:])
        assert first.repeat.tolist() == [1] * 4 + [2] * 4
    if schedule == "single":
        assert len(np.unique(found.pose)) == 6


@pytest.mark.parametrize(("schedule", "loads", "seen"), [("single", 1, False), ("ladder", 3, True)])
def test_a_constant_of_a_pose_is_hidden_where_a_pose_is_read_twice(
    schedule: str, loads: int, seen: bool
) -> None:
    """Read once, it is noise of another size, and nothing can tell the two apart."""
    rng = np.random.default_rng(5)
    at = setting("L1", (5,), rng, schedule=schedule, loads=loads, shared=False, positions=False)
    constant = next(choice for choice in choices(at.arm) if choice.name == "zero_offset")
    assert shows(constant, at) is seen


def test_a_technician_measures_around_a_few_places() -> None:
    arm = six_axis()
    own = plan(arm, np.random.default_rng(2), poses=20, loads=1, clusters=4)
    for name in arm.actuated:
        low, high = arm.limits[name]
        q = own.coordinates[name]
        assert np.all((q >= low) & (q <= high))
        for start in range(0, 20, 5):
            assert np.ptp(q[start : start + 5]) <= (high - low) / 6.0 + 1e-12


def test_a_tracker_drifts_until_it_is_warm() -> None:
    rows = plan(sk120(), np.random.default_rng(1), poses=20, loads=4)
    still = np.zeros((rows.count, 3))
    noise = Noise(1e-12, warm_up=3e-5, warm_time=10.0)
    error, zero = noise.sample(rows, still, still + 1.0, np.random.default_rng(0))
    drift = np.linalg.norm(error - error[-1], axis=1)
    assert drift == pytest.approx(3e-5 * np.exp(-rows.order / 10.0), abs=3e-9)
    assert np.linalg.norm((error - zero)[rows.order > 80], axis=1).max() < 1e-8


def test_what_is_said_of_the_noise() -> None:
    rng = np.random.default_rng(3)
    noise = Noise(1e-5)
    said = [told(noise, rng).declared.get("noise", "well") for _ in range(400)]
    sizes = [entry if entry in (None, "well") else entry["sigma"] for entry in said]  # type: ignore[index]
    for kind, share in (("well", 0.4), (7.0, 0.2), (13.0, 0.2), (None, 0.2)):
        assert sizes.count(kind) / 400 == pytest.approx(share, abs=0.08)
    drawn = [tracker(rng) for _ in range(200)]
    assert 30 < sum(entry.angular > 0.0 for entry in drawn) < 90
    assert 25 < sum(entry.warm_up > 0.0 for entry in drawn) < 80
    case = build("L0", 5, 0)
    small = replace(case, noise=replace(noise, declared={"noise": {"sigma": 7.0, "unit": "um"}}))
    assert description(small, case.train, False)["noise"] == {"sigma": 7.0, "unit": "um"}
    silent = replace(case, noise=replace(noise, declared={"noise": None}))
    assert "noise" not in description(silent, case.train, False)


@pytest.mark.parametrize("make", [sk120, six_axis])
def test_lifelike_causes_are_drawn_with_places_of_the_catalogue(make) -> None:  # type: ignore[no-untyped-def]
    arm = make()
    places = {(cause.name, cause.where) for cause in unit_causes(arm)}
    rng = np.random.default_rng(4)
    world = World(arm, varied(arm, rng))
    rows = plan(arm, rng, poses=3, loads=2, schedule="up_down")
    still = world.displacement(rows)
    for choice in real(arm):
        assert (choice.name, choice.where) in places
        cause = choice.make(rng)
        assert (cause.name, cause.where) == (choice.name, choice.where)
        assert type(cause) not in {type(unit) for unit in unit_causes(arm)}
        change = np.abs(world.with_causes(cause).displacement(rows) - still).max()
        assert 1e-8 < change < 5e-3
        none = world.with_causes(cause.scaled(0.0)).displacement(rows)
        assert np.allclose(none, still, rtol=0, atol=1e-12)


@pytest.fixture(scope="module")
def lifelike() -> Case:
    return build("L10", 21, 1)


def test_lifelike_case_keeps_its_promise(lifelike: Case) -> None:
    assert 1 <= len(lifelike.hidden) <= 3
    for entry in lifelike.hidden:
        assert entry.left >= 8.0
        assert entry.rivals[0].separation >= 6.0
        own = family(entry.cause.name)
        assert not any(r.name in own and r.where == entry.cause.where for r in entry.rivals)
    assert len(lifelike.truth()["laws"]) == len(lifelike.hidden)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("schedule", "shared", "shown"),
    [("up_down", True, True), ("ladder", True, True), ("up_down", False, False),
     ("ascending", True, False), ("single", True, False)],
)  # fmt: skip
def test_a_loop_is_hidden_where_the_loads_can_show_it(
    schedule: str, shared: bool, shown: bool
) -> None:
    at = setting("L10", (1,), np.random.default_rng(1), arm=sk120(), schedule=schedule,
                 shared=shared, positions=False, loads=3, poses=4)  # fmt: skip
    names = {choice.name for choice in lifelike_pool(at) if shows(choice, at)}
    assert ("friction_hysteresis" in names) is shown
    assert {"gear_hardening", "link_bending", "base_rocking"} <= names


def test_remainder_is_what_the_best_exact_fit_leaves() -> None:
    arm = sk120()
    rng = np.random.default_rng(6)
    world = World(arm, varied(arm, rng))
    rows = plan(arm, rng, poses=8, loads=3)
    soft = 1.0 / arm.typical.rocking
    known = BaseRocking("base_link", {"x": soft, "y": 1.5 * soft})
    strange = RubberMount("tool0", {"compliance": 1e-7}, {"full": 150.0})
    noise = Noise(1e-5)
    seen = view(world, rows, noise)
    left = remainder(seen, blocks(seen, unit_causes(arm)), known, strange)

    data = world.with_causes(known, strange).displacement(rows)
    names = list(world.springs)

    def misses(factors: np.ndarray) -> np.ndarray:
        springs = {n: world.springs[n] * f for n, f in zip(names, factors, strict=False)}
        sizes = dict(zip("xyz", soft * factors[len(names) :], strict=True))
        model = replace(world, springs=springs).with_causes(BaseRocking("base_link", sizes))
        return seen.white @ (model.displacement(rows) - data).reshape(-1)

    start = np.concatenate([np.ones(len(names)), [1.0, 1.5, 0.0]])
    fit = least_squares(misses, start, method="lm")
    exact = np.linalg.solve(seen.white, fit.fun)
    assert np.sqrt(np.mean(exact**2)) == pytest.approx(np.sqrt(np.mean(left**2)), rel=0.03)
    assert np.sqrt(np.mean(left**2)) > 2e-6


def test_foreign_beside_known_stays_out_of_the_list() -> None:
    assert not build("L0.plans", 21, 0).hidden
    truth = build("L12", 21, 0).truth()
    assert len(truth["effects"]) == 1  # type: ignore[arg-type]
    assert str(truth["foreign"]).startswith("foreign_")
    assert float(truth["remainder_um"]) > 0.5  # type: ignore[arg-type]
