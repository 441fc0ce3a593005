"""Deflections of a map: one enhanced step, near the exact equilibrium, ± as the model says it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sk120stiff.effects import effect, load_case
from sk120stiff.errors import InputError
from sk120stiff.model import (
    Model,
    Remainder,
    Uncertainty,
    joint_spring_model,
    loaded_stiffness,
    predict_with_uncertainty,
)
from sk120stiff.robot import load_robot
from sk120stiff.show import cloud_of_map, figures_of_map
from sk120stiff.workspace import Axis, Grid, JointGrid, MapJob, elastic_arm, open_map, write_map

LOADS = np.array([[0.0, 0.0, -490.0, 0.0, 0.0, 0.0], [300.0, 200.0, 100.0, 10.0, -20.0, 30.0]])
REST = np.array([0.2, 0.0, 0.0, 0.3, 0.0, 0.1])


def known(model: Model, **changes: object) -> Model:
    std = 0.02 * np.array([p.internal or 0.05 * p.spec.typical for p in model.parameters])
    P = len(model.parameters)
    parts = {
        "names": model.names,
        "values": model.values,
        "covariance": np.outer(std, std) * (0.3 + 0.7 * np.eye(P)),
        "unseen": np.zeros((0, P)),
        "noise": 10e-6,
        "remainder": Remainder(
            rms=np.array([1e-5, 2e-5, 3e-5]),
            upper=np.array([2e-5, 3e-5, 4e-5]),
            freedom=np.full(3, 40.0),
            load=400.0,
            length=2.0,
            grows=True,
            probability=1e-6,
            significant=True,
        ),
    }
    return model.known(Uncertainty(**{**parts, **changes}))


@pytest.fixture(scope="module")
def springs() -> Model:
    robot = load_robot("motoman_sk120")
    return joint_spring_model(robot, [1.4098e6, 4.0076e5, 9.3528e5, np.inf, np.inf, np.inf])


def job_of(model: Model, count: int = 4) -> MapJob:
    axes = tuple(
        Axis(name, np.linspace(-0.9, 0.4, count))
        for name in ("joint_2_l", "joint_3_u", "joint_5_b")
    )
    return MapJob(elastic_arm(model), JointGrid(Grid(axes), REST), LOADS)


def poses_of(job: MapJob) -> np.ndarray:
    return job.points.poses(job.arm, 0, job.points.grid.size)[0]


def check_against_equilibrium(model: Model, job: MapJob, rtol: float) -> None:
    found = job.compute(0, job.points.grid.size)
    a = poses_of(job)
    for number, load in enumerate(LOADS):
        exact = predict_with_uncertainty(model, load_case(model.robot, a, load))
        length = np.linalg.norm(exact.displacement, axis=1)
        off = np.linalg.norm(found["deflection"][number] - exact.displacement, axis=1)
        assert (off < 3e-3 * length).all()
        one_step = loaded_stiffness(model, a[5], load).deflection_enhanced
        np.testing.assert_allclose(found["deflection"][number, 5], one_step, rtol=1e-4)
        along = exact.displacement / length[:, None]
        # ± of a length: the covariance along the displacement, from the derivatives of prediction
        L, _ = model.uncertainty.factors(model.names)
        _, derivative = model.predict_with_sensitivities(load_case(model.robot, a, load))
        std = np.linalg.norm(np.einsum("ni,nip->np", along, derivative) @ L, axis=1)
        np.testing.assert_allclose(
            found["deflection_std_parameters"][number], std, rtol=rtol, atol=1e-9
        )
        left = np.sqrt((along**2 * exact.std_remainder**2).sum(axis=1))
        np.testing.assert_allclose(found["deflection_std_remainder"][number], left, rtol=1e-2)


def test_a_map_bends_as_the_exact_equilibrium_but_for_parts_in_a_thousand(springs: Model) -> None:
    model = known(springs)
    check_against_equilibrium(model, job_of(model), rtol=0.02)


def test_so_does_an_arm_whose_springs_change_with_the_pose(springs: Model) -> None:
    """A gravity compensator: the compiled kernel is told its spring at every pose."""
    extra = springs + effect(springs.robot, "gravity_compensator", "joint_2_l")
    size = 0.2 * extra.parameters[-1].spec.typical
    model = known(extra.with_values(np.array([*springs.values, size])))
    job = job_of(model, 3)
    assert not job.arm.compiled
    check_against_equilibrium(model, job, rtol=0.02)


def test_a_joint_that_is_rigid_within_its_uncertainty_counts(springs: Model) -> None:
    """Wrist springs on their bound have a ± and bend nothing."""
    robot = springs.robot
    wrist = [effect(robot, "joint_springs", joint) for joint in robot.actuated[3:5]]
    model = springs
    for spring in wrist:
        model = model + spring
    check_against_equilibrium(known(model), job_of(known(model), 3), rtol=0.03)


def test_what_does_not_show_is_infinite_in_a_map(springs: Model) -> None:
    blind = np.array([[0.0, 0.0, 5.0 * springs.values[2]]])
    found = job_of(known(springs, unseen=blind)).compute(0, 64)
    assert np.isinf(found["deflection_std_parameters"]).any()
    assert np.isfinite(found["deflection"]).all()


def test_an_unstable_arm_has_no_deflection(springs: Model) -> None:
    job = job_of(known(springs))
    found = replace(job, loads=3000.0 * LOADS).compute(0, 64)
    unstable = found["stability"] != 0
    assert unstable.any() and np.isnan(found["deflection_length"][unstable]).all()
    assert np.isnan(found["deflection_std_parameters"][unstable]).all()
    assert np.isfinite(found["deflection_length"][~unstable]).all()


def test_it_is_stored_drawn_and_shown_and_another_uncertainty_is_another_map(
    springs: Model, tmp_path: Path
) -> None:
    model = known(springs)
    write_map(job_of(model), tmp_path / "m.zarr")
    dataset = open_map(tmp_path / "m.zarr")
    assert dataset["deflection"].dims[-1] == "axis"
    assert dataset["deflection_std_parameters"].attrs["units"] == "m"
    names = [figure.name for figure in figures_of_map(dataset)]
    assert "load1_joint_2_l_joint_3_u_deflection" in names
    assert "load1_joint_2_l_joint_3_u_deflection_uncertainty" in names
    cloud = cloud_of_map(dataset, springs.robot, variable="deflection_length")
    assert cloud.unit == "µm"
    stored = np.asarray(dataset["deflection_length"].isel(load=0)).ravel()
    np.testing.assert_allclose(cloud.values, 1e6 * stored, rtol=1e-6)
    other = known(springs, covariance=1.1 * model.uncertainty.covariance)
    with pytest.raises(InputError, match="another map"):
        write_map(job_of(other), tmp_path / "m.zarr")


def test_without_load_or_uncertainty_nothing_is_stored_in_vain(springs: Model) -> None:
    plain = job_of(springs)
    names = [variable.name for variable in plain.variables]
    assert "deflection" in names and "deflection_std_parameters" not in names
    still = replace(plain, loads=np.zeros((1, 6)))
    assert not any("deflection" in variable.name for variable in still.variables)
