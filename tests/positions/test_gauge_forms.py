"""The same gauges as d with a direction, and as dx, dy, dz with blanks: one answer."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import sk120stiff as sk
from sk120stiff.effects import load_cases_of
from sk120stiff.errors import InputError
from sk120stiff.explain import Explanation
from sk120stiff.identify import as_moved
from sk120stiff.measurements import FormWhitener, Measurements, ModelForm, as_displacements
from sk120stiff.measurements.directions import in_columns, turns_onto
from sk120stiff.measurements.files.writing import write_measurements
from tests.positions.arm import Arm, Array, poses
from tests.positions.loaded_arm import MARKERS, SPRINGS, moved, write_moved

POINT = "point: {xyz: [150, 0, 100], unit: mm}\nnoise: {sigma: 5, unit: um}\n"
SIGMA = 5e-6  # m, of a reading and of its zero alike
ROCKING = 4e-7  # rad/(N·m)
OBLIQUE = Rotation.from_rotvec([0.5, -0.4, 0.7]).as_matrix()
COUNT = 16


def gauged(folder: Path, axes: Array, rocking: float, form: str, seed: int = 3) -> Measurements:
    """A gauge along plus or minus each of three axes (3, 3), at each of 16 poses."""
    rng = np.random.default_rng(seed)
    a = np.repeat(poses(COUNT, seed), 6, axis=0)
    force = 400.0 * rng.normal(size=(len(a), 3))
    sign = rng.choice([-1.0, 1.0], len(a))
    along = sign[:, None] * np.tile(axes, (2 * COUNT, 1))
    d, _ = moved(Arm(compliance=SPRINGS, weighs=False), a, force, MARKERS["A"], rocking)
    zero = sign * np.repeat(SIGMA * rng.normal(size=(COUNT, 3)), 2, axis=0).reshape(-1)
    read = (along * d).sum(axis=1) + SIGMA * rng.normal(size=len(a)) - zero
    if form == "d":
        columns = {"d[mm]": 1e3 * read} | {f"u{n}": along[:, k] for k, n in enumerate("xyz")}
    else:
        cells = in_columns(along, 1e3 * read)
        columns = {f"d{n}[mm]": cells[:, k] for k, n in enumerate("xyz")}
    folder.mkdir()
    return sk.read(write_moved(folder, a, force, columns, POINT))


def answered(data: Measurements) -> Explanation:
    found = sk.explain(sk.base_model(robot_of(data)), data)
    assert isinstance(found, Explanation)
    return found


def robot_of(data: Measurements) -> sk.Robot:
    return sk.load_robot(data.robot, base="base", tool="tool")


def named(found: Explanation) -> list[str]:
    return [finding.effect.id for finding in found.findings]


@pytest.mark.parametrize("rocking", [0.0, ROCKING])
def test_both_forms_have_one_answer(tmp_path: Path, rocking: float) -> None:
    one, other = (
        answered(gauged(tmp_path / form, np.eye(3), rocking, form)) for form in ("d", "dx")
    )
    assert named(one) == named(other) == (["base_rocking:base"] if rocking else [])
    assert one.verdict == other.verdict
    np.testing.assert_allclose(one.final.model.values, other.final.model.values, rtol=1e-6)
    np.testing.assert_allclose(one.final.covariance, other.final.covariance, rtol=1e-4, atol=0.0)


@pytest.mark.parametrize("rocking", [0.0, ROCKING])
def test_oblique_gauges_are_explained_as_those_along_axes(tmp_path: Path, rocking: float) -> None:
    found = answered(gauged(tmp_path / "d", OBLIQUE, rocking, "d"))
    assert named(found) == (["base_rocking:base"] if rocking else [])
    for k, compliance in enumerate(SPRINGS, start=1):
        if not rocking or k != 1:
            p = found.final.model.parameter(f"joint_springs:j{k}.stiffness")
            own = next(x for x in found.final.parameters if x.name == p.name)
            assert abs(p.internal - compliance) < 4.0 * own.internal_std


def test_held_out_gauges_may_have_the_other_form(tmp_path: Path) -> None:
    data = gauged(tmp_path / "dx", np.eye(3), 0.0, "dx")
    held = gauged(tmp_path / "d", OBLIQUE, 0.0, "d", seed=4)
    found = sk.explain(sk.base_model(robot_of(data)), data, holdout=held)
    assert found.steps[-1].heldout_rms < 2.0 * SIGMA


def test_identify_and_predict_take_gauges_as_displacements(tmp_path: Path) -> None:
    data = gauged(tmp_path / "d", OBLIQUE, 0.0, "d")
    found = sk.fit(sk.base_model(robot_of(data)), data)
    std = np.sqrt(np.diag(found.covariance)) * found.problem.scale
    assert (np.abs(found.model.values - SPRINGS) < 4.0 * std).all()
    assert found.rms < 2.0 * SIGMA
    said = sk.predict(found.model, data)
    channels = data.absolute.channels  # type: ignore[union-attr]
    gap = channels.shift - np.einsum("ni,ni->n", channels.along, said.displacement)
    np.testing.assert_allclose(np.sqrt(np.mean(gap**2)), found.rms, rtol=1e-9)


def test_gaps_of_gauges_are_told_as_the_file_has_them(tmp_path: Path) -> None:
    """Along the stated direction, with its sign."""
    data = gauged(tmp_path / "d", OBLIQUE, 0.0, "d")
    answered(data).save(tmp_path / "out")
    head, *rows = (tmp_path / "out" / "gaps.csv").read_text("utf-8").splitlines()
    names = head.split(",")
    cells = np.array(
        [[row.split(",")[names.index(n)] for n in ("d[mm]", "gap_d[um]")] for row in rows]
    )
    read, gap = cells.astype(float).T
    np.testing.assert_allclose(read, 1e3 * data.absolute.channels.shift)  # type: ignore[union-attr]
    assert np.sqrt(np.mean(gap**2)) < 2e6 * SIGMA


def test_gauges_are_written_as_they_were_read(tmp_path: Path) -> None:
    data = as_displacements(gauged(tmp_path / "d", OBLIQUE, 0.0, "d"))
    back = as_displacements(sk.read(sk.write_measurements(data, tmp_path / "again.csv")))
    np.testing.assert_allclose(back.displacement, data.displacement, rtol=1e-12)
    np.testing.assert_allclose(back.directions, data.directions, rtol=1e-12)
    assert back.zero == data.zero and (back.zero_group == data.zero_group).all()


def test_axes_are_turned_the_shortest_way_onto_directions() -> None:
    u = np.random.default_rng(1).normal(size=(50, 3))
    u /= np.linalg.norm(u, axis=1)[:, None]
    turns = turns_onto(u)
    np.testing.assert_allclose(
        turns @ np.swapaxes(turns, 1, 2), np.tile(np.eye(3), (50, 1, 1)), atol=1e-12
    )
    axis = np.abs(u).argmax(axis=1)
    along = np.take_along_axis(turns, axis[:, None, None], axis=2)[:, :, 0]
    np.testing.assert_allclose(np.cross(along, u), 0.0, atol=1e-12)
    assert (turns_onto(np.vstack([np.eye(3), -np.eye(3)])) == np.eye(3)).all()


@pytest.mark.parametrize("zero", ["shared", "separate"])
def test_three_gauges_are_one_displacement(tmp_path: Path, zero: str) -> None:
    """Whatever noise and the model's form are, along any three axes at right angles."""
    data = as_displacements(gauged(tmp_path / "d", OBLIQUE, 0.0, "d"))
    wrench = np.repeat(data.wrench[::3], 3, axis=0)  # three gauges under one load
    d = data.displacement[np.isfinite(data.displacement)].reshape(-1, 3)
    along = np.tile(OBLIQUE, (2 * COUNT, 1))
    form = ModelForm(0.05, 2e-6)
    turned = replace(
        data, wrench=wrench, directions=along, displacement=in_columns(along, d.ravel()), zero=zero,
        zero_group=data.pose_index if zero == "shared" else np.arange(len(wrench)),
    )  # fmt: skip
    whole = replace(turned.select(np.arange(0, len(wrench), 3)), directions=None)
    whole = replace(whole, displacement=d @ OBLIQUE)
    noise = sk.NoiseModel(SIGMA, 0.0, zero, form=form)  # type: ignore[arg-type]
    one, other = noise.whitener(turned), noise.whitener(whole)
    assert isinstance(one, FormWhitener)
    assert one.logdet == pytest.approx(other.logdet, rel=1e-9)
    chi = [np.sum(w.apply(m.moved) ** 2) for w, m in ((one, turned), (other, whole))]
    assert chi[0] == pytest.approx(chi[1], rel=1e-9)
    model = sk.base_model(robot_of(data))
    told = model.predict(load_cases_of(model.robot, turned))
    base = model.predict(load_cases_of(model.robot, whole))
    np.testing.assert_allclose(
        told[np.isfinite(turned.displacement)].reshape(-1, 3), base @ OBLIQUE.T, atol=1e-12
    )


def test_gauges_share_a_zero_with_those_of_their_direction_alone(tmp_path: Path) -> None:
    """Two of them are nearest to x; the third reads against the first."""
    data = as_displacements(gauged(tmp_path / "d", OBLIQUE, 0.0, "d")).select([0, 1, 2])
    u = np.array([[0.8, 0.6, 0.0], [0.8, 0.0, 0.6], [-0.8, -0.6, 0.0]])
    data = replace(data, directions=u, displacement=in_columns(u, np.full(3, 1e-4)))
    V = sk.NoiseModel(SIGMA).covariance(data)[0] / SIGMA**2
    np.testing.assert_allclose(V, [[2.0, 0.0, 1.0], [0.0, 2.0, 0.0], [1.0, 0.0, 2.0]])


def again(data: Measurements, first: Measurements) -> Measurements:
    """A second campaign with the same robot."""
    return replace(data, robot=first.robot, pose=tuple(f"{pose}_again" for pose in data.pose))


def test_gauges_along_axes_join_displacements(tmp_path: Path) -> None:
    """A hold-out file of the other form is asked about what has no name, too."""
    d, dx = (
        as_displacements(gauged(tmp_path / form, np.eye(3), 0.0, form)) for form in ("d", "dx")
    )
    for one, other in ((d, dx), (dx, d)):
        both = one + again(other, one)
        assert both.directions is None
        np.testing.assert_array_equal(
            both.displacement, np.vstack([one.displacement, other.displacement])
        )


def test_oblique_gauges_beside_displacements_are_fitted_and_not_written(tmp_path: Path) -> None:
    oblique = as_displacements(gauged(tmp_path / "d", OBLIQUE, 0.0, "d"))
    dx = gauged(tmp_path / "dx", np.eye(3), 0.0, "dx")
    whole = replace(dx, displacement=np.nan_to_num(dx.displacement))
    both = oblique + again(whole, oblique)
    model = sk.base_model(robot_of(dx))
    told = model.predict(load_cases_of(model.robot, both))
    apart = [model.predict(load_cases_of(model.robot, each)) for each in (oblique, whole)]
    np.testing.assert_allclose(told, np.vstack(apart), rtol=1e-12, atol=0.0)
    with pytest.raises(InputError, match="one file holds either"):
        write_measurements(both, tmp_path / "both.csv")


def test_springs_that_are_known_make_gauges_displacements_too(tmp_path: Path) -> None:
    data = gauged(tmp_path / "d", np.eye(3), 0.0, "d")
    model = sk.base_model(robot_of(data))
    held = replace(model, parameters=tuple(replace(p, free=False) for p in model.parameters))
    assert as_moved(held, data).displacement is not None
    assert as_moved(sk.Model(model.robot), data) is data
