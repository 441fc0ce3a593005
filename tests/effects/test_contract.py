"""What every effect of the catalogue must keep to, at every place of several robots.

A new effect is tried here without a line of its own, and so are two from outside the package.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pint
import pytest

from sk120stiff.effects import Elastic, LinearElastic, LoadCases, Switching, effect
from sk120stiff.effects.nonlinear import Nonlinear
from sk120stiff.model import Model, joint_spring_model, model_from_text, model_text
from sk120stiff.units import is_kind, is_unit, to_si
from tests.effects.arms import (
    ARMS,
    LOOPED,
    Array,
    arm,
    every_effect,
    random_values,
    readings,
    some_poses,
    sprung,
    with_every_effect,
)
from tests.effects.outside import EVERYTHING

REGISTRY = pint.UnitRegistry()
CASES = [
    pytest.param(name, found, id=f"{name}-{found.id}")
    for name in ARMS
    for found in every_effect(arm(name))
]
ELASTIC = [case for case in CASES if isinstance(case.values[1], Elastic)]
BENT = [
    pytest.param(name, law, id=f"{name}-{law.id}-{law.parameters[-1].name}")
    for name in ("sk120", "scara", "loop")
    for usual in {found.name: found for found in every_effect(arm(name))}.values()
    for law in usual.other_laws(readings(arm(name), 6, seed=2))
    if isinstance(law, Nonlinear)
]
LINEAR = [case for case in CASES if isinstance(case.values[1], LinearElastic)]


@pytest.mark.parametrize("name", ARMS)
def test_no_law_of_an_effect_comes_twice(name: str) -> None:
    """Loads along the first axis put no torque on it, and no gear has steps there."""
    robot = arm(name)
    along = readings(robot, 6, seed=2, moments=False)
    along = replace(along, wrench=along.wrench * [0, 0, 1, 0, 0, 0])
    for found in every_effect(robot):
        for usual in (found, *found.other_laws(along)):
            laws = usual.other_laws(along)
            assert len(set(laws)) == len(laws) and usual not in laws, usual


def alone(name: str, found: object, seed: int = 1) -> Model:
    """Springs and one more effect at values that are not zero."""
    model = sprung(arm(name))
    if found.name == "joint_springs":
        return model
    model = model + found
    values = random_values(model, np.random.default_rng(seed))
    values[: arm(name).n] = sprung(arm(name)).values
    return model.with_values(values)


def differences(model: Model, load_cases: LoadCases, columns: range | None = None) -> Array:
    """(N, 3, P) fourth-order central differences of `predict` by typical steps."""
    out = []
    for k in columns or range(len(model.values)):
        step = np.zeros(len(model.values))
        step[k] = 0.02 * model.parameters[k].spec.typical

        def moved(by: float, step: Array = step) -> Array:
            return model.predict(load_cases, model.values + by * step)

        near, far = moved(1) - moved(-1), moved(2) - moved(-2)
        out.append((8.0 * near - far) / (12.0 * step[k]))
    return np.stack(out, axis=-1)


def assert_same_columns(model: Model, exact: Array, differences: Array, first: int = 0) -> None:
    for k in range(differences.shape[-1]):
        size = np.abs(differences[..., k]).max()
        # what a micrometre of rounding noise would be: one part in 1e13 of the arm over the step
        floor = 2e-12 / model.parameters[first + k].spec.typical
        error = np.abs(exact[..., first + k] - differences[..., k]).max()
        assert error <= 2e-7 * size + floor, (model.names[first + k], error / size)


@pytest.mark.parametrize("follows", [False, True])
@pytest.mark.parametrize("name", [*ARMS, *LOOPED])
def test_sensitivities_of_all_effects_together(name, follows):
    """Along random directions in the space of all parameters, each of usual size."""
    model = with_every_effect(arm(name))
    load_cases = replace(readings(arm(name), 6), follows=follows)
    predicted, exact = model.predict_with_sensitivities(load_cases)
    assert np.allclose(predicted, model.predict(load_cases), rtol=0, atol=1e-14)
    typical = np.array([parameter.spec.typical for parameter in model.parameters])
    rng = np.random.default_rng(10)
    for _ in range(10):
        direction = 0.005 * typical * rng.normal(size=len(typical))  # no gear jumps so near

        def moved(by: float, direction: Array = direction) -> Array:
            return model.predict(load_cases, model.values + by * direction)

        slope = (8.0 * (moved(1) - moved(-1)) - moved(2) + moved(-2)) / 12.0
        assert np.abs(slope).max() > 1e-7
        assert np.allclose(exact @ direction, slope, rtol=0, atol=1e-7 * np.abs(slope).max())


@pytest.mark.parametrize(("name", "found"), [*CASES, *BENT])
def test_sensitivities_of_one_effect(name, found):
    model, load_cases = alone(name, found), readings(arm(name), 6, seed=2)
    exact = model.predict_with_sensitivities(load_cases)[1]
    first = 0 if found.name == "joint_springs" else arm(name).n
    assert_same_columns(
        model, exact, differences(model, load_cases, range(first, len(model.values))), first
    )


@pytest.mark.parametrize(("name", "found"), CASES)
def test_no_effect_at_zero(name, found):
    load_cases = readings(arm(name), seed=3)
    model = sprung(arm(name))
    plain = model.predict(load_cases)
    if found.name == "joint_springs":
        model = model.without(found.id)
        absent, rigid = model + found, model.predict(load_cases)
        assert np.abs(absent.predict(load_cases) - rigid).max() < 1e-15
        return
    added = model + found
    assert not added.values[len(model.values) :].any()
    assert np.abs(added.predict(load_cases) - plain).max() < 1e-14


@pytest.mark.parametrize("name", ARMS)
def test_every_kind_of_effect_shows_somewhere(name):
    """A law that does nothing would pass all else."""
    robot, seen, all_kinds = arm(name), set(), set()
    plain = readings(robot, seed=4)
    load_cases = replace(plain, wrench=6.0 * plain.wrench)  # lifts joints off their weight
    for found in every_effect(robot):
        all_kinds.add(found.name)
        model = joint_spring_model(robot, np.full(robot.n, 1e7))
        model = model if found.name == "joint_springs" else model + found
        columns = model.predict_with_sensitivities(load_cases)[1]
        typical = np.array([p.spec.typical for p in model.parameters])
        own = [k for k, p in enumerate(model.parameters) if p.effect.id == found.id]
        if (np.abs(columns * typical)[..., own] > 1e-11).any():
            seen.add(found.name)
    assert seen == all_kinds


@pytest.mark.parametrize(("name", "found"), [*ELASTIC, *BENT])
def test_tangent_compliance_is_the_slope_of_the_elongation(name, found):
    load_cases = readings(arm(name), seed=5)
    rng = np.random.default_rng(6)
    values = random_values(Model(arm(name)) + found, rng)
    k = len(found.coordinates(arm(name)))
    torques = 150.0 * rng.normal(size=(load_cases.count, k))
    law = found.elongation(torques, load_cases, values)
    assert law.value.shape == (load_cases.count, k)
    assert law.by_torque.shape == (load_cases.count, k, k)
    assert law.by_parameter.shape == (load_cases.count, k, len(values))
    for j in range(k):
        step = np.zeros(k)
        step[j] = 1e-2
        ahead = found.elongation(torques + step, load_cases, values).value
        behind = found.elongation(torques - step, load_cases, values).value
        slope = (ahead - behind) / 2e-2
        assert np.allclose(law.by_torque[..., j], slope, rtol=1e-7, atol=1e-16)
    if isinstance(found, Switching):
        assert not law.by_torque.any()
    assert np.allclose(law.by_torque, np.swapaxes(law.by_torque, -1, -2), rtol=0, atol=1e-20)


@pytest.mark.parametrize(("name", "found"), LINEAR)
def test_compliances_store_energy(name, found):
    """Symmetric, and nowhere negative unless the parameter is declared to have either sign."""
    patterns = found.patterns(readings(arm(name), seed=7))
    assert len(patterns) == len(found.parameters)
    for pattern, spec in zip(patterns, found.parameters, strict=True):
        assert np.array_equal(pattern, np.swapaxes(pattern, -1, -2))
        least = np.linalg.eigvalsh(pattern)[..., 0]
        assert (least >= 0.0).all() or spec.lower == -np.inf


@pytest.mark.parametrize("name", [*ARMS, *LOOPED])
def test_work_of_the_load_is_the_energy_in_the_springs(name):
    """∫ F · dX over the loading path, all linear effects at once: stored energy to rounding.

    Without gravity, which stores energy of its own.
    """
    robot = replace(arm(name), gravity=np.zeros(3))
    model = sprung(robot)
    for found in every_effect(robot):
        if isinstance(found, LinearElastic) and found.name != "joint_springs":
            model = model + found
    values = random_values(model, np.random.default_rng(8), 0.5)
    values[: robot.n] = sprung(robot).values
    plain = readings(robot, seed=9, moments=False)
    load_cases = replace(
        plain, force_point=plain.point, reading_axes=np.broadcast_to(np.eye(3), (12, 3, 3))
    )
    solution = model.solve(load_cases, values)
    energy = np.zeros(load_cases.count)
    for law, part, index in model.assembly.elastic:
        torque = solution.rest.torques[:, index]
        energy += 0.5 * (torque * law.elongation(torque, load_cases, values[part]).value).sum(-1)
    force = load_cases.wrench[:, :3]
    work = (force * solution.displacement).sum(-1)  # λ F · X at the end, minus ∫ F · X dλ
    nodes, weights = np.polynomial.legendre.leggauss(12)
    for node, weight in zip(0.5 * (nodes + 1.0), 0.5 * weights, strict=True):
        part = replace(load_cases, wrench=node * load_cases.wrench)
        work -= weight * (force * model.predict(part, values)).sum(-1)
    assert (energy > 1e-4).all()
    assert np.allclose(work, energy, rtol=1e-10)


@pytest.mark.parametrize(("name", "found"), [*CASES, *BENT])
def test_parameters_are_fit_for_use(name, found):
    names = [spec.name for spec in found.parameters]
    assert len(set(names)) == len(names) > 0
    for spec in found.parameters:
        assert 0.0 < spec.typical < spec.plausible < np.inf
        assert spec.lower in (0.0, -np.inf) and spec.upper == np.inf
        for value in (spec.typical, 0.37 * spec.typical, spec.plausible):
            assert np.isclose(spec.internal(spec.public(value)), value, rtol=1e-15)
        assert spec.internal(spec.public(0.0)) == 0.0
        assert spec.reciprocal == np.isinf(spec.public(0.0))
        if spec.reciprocal:
            assert spec.public(spec.plausible) < spec.public(spec.typical)
            # a standard error of one per cent is one per cent of either value
            error = spec.public_std(spec.typical, 0.01 * spec.typical)
            assert np.isclose(error, 0.01 * spec.public(spec.typical), rtol=1e-14)
        else:
            assert spec.unit == spec.internal_unit
    for group in found.ties:
        assert len(group) > 1
        assert len({(names[k][:-1], found.parameters[k].unit) for k in group}) <= len(group)
        assert len({found.parameters[k].unit for k in group}) == 1


@pytest.mark.parametrize(("name", "found"), [*CASES, *BENT])
def test_units_mean_what_they_say(name, found):
    """Units parse, are SI, and the internal one is the reciprocal where the value is."""
    for spec in found.parameters:
        outer, inner = REGISTRY.parse_units(spec.unit), REGISTRY.parse_units(spec.internal_unit)
        for unit in (outer, inner):
            assert np.isclose((1.0 * unit).to_base_units().magnitude, 1.0)
        product = outer * inner if spec.reciprocal else outer / inner
        assert product.dimensionless
        kinds = {"rad": "angle", "m": "length", "N": "force", "N*m/rad": "stiffness_angular",
                 "N/m": "stiffness_linear"}  # fmt: skip
        if spec.unit in kinds:
            assert is_unit(spec.unit) and is_kind(spec.unit, kinds[spec.unit])
            assert to_si(1.0, spec.unit, kinds[spec.unit]) == 1.0


@pytest.mark.parametrize(("name", "found"), CASES)
def test_words_and_place(name, found):
    assert found.where in type(found).places(arm(name))
    assert found.id == f"{found.name}:{found.where}"
    sentence = found.sentence()
    assert sentence[0].isupper() and sentence.endswith(".") and len(sentence) > 20
    again = effect(
        arm(name),
        found.name,
        found.where,
        poses=tuple("ABCDEF"),
        timed=True,
        catalogue=EVERYTHING,
    )
    assert again == found and hash(again) == hash(found)


@pytest.mark.parametrize("name", [*ARMS, *LOOPED])
def test_batch_equals_loop(name):
    model, load_cases = with_every_effect(arm(name)), readings(arm(name))
    predicted, exact = model.predict_with_sensitivities(load_cases)
    for k in range(load_cases.count):
        one, slope = model.predict_with_sensitivities(load_cases.rows(slice(k, k + 1)))
        assert np.abs(one[0] - predicted[k]).max() < 1e-13
        assert np.allclose(slope[0], exact[k], rtol=1e-9, atol=1e-12 * np.abs(exact).max((0, 1)))


@pytest.mark.parametrize("name", [*ARMS, *LOOPED])
def test_models_are_written_and_read_without_loss(name):
    model = with_every_effect(arm(name))
    errors = [0.01 * abs(value) for value in model.values]
    model = model.with_values(model.values, errors, origin="made up")
    frozen = replace(model.parameters[3], free=False, internal_std=None)
    model = replace(model, parameters=(*model.parameters[:3], frozen, *model.parameters[4:]))
    model = replace(model, provenance={"command": "none", "data": "sha256:0"})
    again = model_from_text(model_text(model), robot=arm(name), catalogue=EVERYTHING)
    assert again.names == model.names and again.effects == model.effects
    assert again.provenance == model.provenance
    assert np.allclose(again.values, model.values, rtol=4e-16, atol=0)
    for read, written in zip(again.parameters, model.parameters, strict=True):
        assert (read.free, read.origin) == (written.free, written.origin)
        assert (read.internal_std is None) == (written.internal_std is None)
        assert read.internal_std is None or np.isclose(
            read.internal_std, written.internal_std, rtol=1e-14
        )
    load_cases = readings(arm(name))
    assert np.abs(again.predict(load_cases) - model.predict(load_cases)).max() < 1e-14


def test_absent_effects_survive_the_file():
    model = sprung(arm("sk120")) + effect(arm("sk120"), "base_rocking")
    again = model_from_text(model_text(model), robot=arm("sk120"))
    assert np.array_equal(again.values[-2:], [0.0, 0.0])


@pytest.mark.parametrize("name", ARMS)
def test_poses_of_the_tests_are_within_limits(name):
    poses = some_poses(arm(name), 50, np.random.default_rng(0))
    assert (poses >= arm(name).lower).all() and (poses <= arm(name).upper).all()
