"""Instruments that are sharp along their ray: stated, told by uncertainties, and whitened by."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.errors import InputError
from sk120stiff.identify import as_seen
from sk120stiff.measurements import Measurements, NoiseModel, NoiseStatement, seen_from
from sk120stiff.measurements.noise.line_of_sight import SEEN, told_by

RNG = np.random.default_rng(5)
POINTS = RNG.uniform([0.8, -0.9, 0.4], [1.9, 0.9, 1.9], size=(20, 3))
TRACKER = sk.Instrument((3.4, -2.7, 0.9), 4e-6, 9e-6, across_per_m=3e-6)


def covariances(instrument: sk.Instrument, points: np.ndarray) -> np.ndarray:
    """(N, 3, 3) in base axes, point by point."""
    out = []
    for point in points:
        sight = point - np.array(instrument.place)
        far = np.sqrt(sight @ sight)
        ray = np.outer(sight, sight) / far**2
        along = instrument.along**2 + (instrument.along_per_m * far) ** 2
        across = instrument.across**2 + (instrument.across_per_m * far) ** 2
        out.append(along * ray + across * (np.eye(3) - ray))
    return np.array(out)


def sigmas(instrument: sk.Instrument, points: np.ndarray) -> np.ndarray:
    return np.sqrt(np.einsum("nii->ni", covariances(instrument, points)))


def readings(**more: object) -> Measurements:
    pose = tuple(str(k // 3) for k in range(24))
    return Measurements(
        pose=pose,
        joint_names=("q",),
        joints=np.array([[float(p)] for p in pose]),
        wrench=RNG.normal(size=(24, 6)),
        displacement=RNG.normal(size=(24, 3)) * 5e-4,
        **more,  # type: ignore[arg-type]
    )


@pytest.mark.parametrize(
    "place", [(3.4, -2.7, 0.9), (-2.0, 0.3, 1.2), (1.2, 4.5, 2.5), (1.5, 0.2, -3.0)]
)
def test_uncertainties_of_the_axes_tell_the_place_of_the_instrument(
    place: tuple[float, float, float],
) -> None:
    there = replace(TRACKER, place=place)
    found = told_by(POINTS, np.round(sigmas(there, POINTS), 8))  # as told: to 0.01 µm
    assert found is not None
    np.testing.assert_allclose(found.place, place, atol=0.15)
    _, along, across = found.at(POINTS)
    _, expected_along, expected_across = there.at(POINTS)
    np.testing.assert_allclose(along, expected_along, rtol=0.05)
    np.testing.assert_allclose(across, expected_across, rtol=0.05)


def test_an_instrument_that_is_perfect_along_its_ray_still_has_readings() -> None:
    perfect = replace(TRACKER, along=1e-12)
    found = told_by(POINTS, sigmas(perfect, POINTS))
    assert found is not None
    assert 0.0 < found.along < 0.05 * TRACKER.across


def test_what_any_other_law_makes_of_uncertainties_is_no_instrument() -> None:
    size = RNG.uniform(0.0, 1e-3, (20, 1))
    growing = np.sqrt(1e-10 + (0.03 * size) ** 2) * np.ones(3)
    drawn = RNG.uniform(4e-6, 20e-6, (20, 3))
    for told in (np.full((20, 3), 1e-5), np.tile([1e-5, 1.4e-5, 2e-5], (20, 1)), growing, drawn):
        assert told_by(POINTS, told) is None
    off = sigmas(TRACKER, POINTS) * RNG.uniform(0.95, 1.05, (20, 3))  # more than rounding
    assert told_by(POINTS, off) is None
    alike = replace(TRACKER, along=TRACKER.across, along_per_m=TRACKER.across_per_m)
    assert told_by(POINTS, sigmas(alike, POINTS)) is None  # what independent axes have as well
    flat = POINTS * [0.0, 1.0, 1.0] + [1.2, 0.0, 0.0]  # from the front as well as from behind
    assert told_by(flat, sigmas(TRACKER, flat)) is None
    assert told_by(POINTS[:5], sigmas(TRACKER, POINTS[:5])) is None


@pytest.mark.parametrize("zero", ["shared", "separate"])
def test_whitening_is_along_the_ray_and_across_it(zero: str) -> None:
    places = np.repeat(POINTS[:8], 3, axis=0)
    m = readings(zero=zero, noise=NoiseStatement(instrument=TRACKER))
    m = seen_from(m, places)
    own = covariances(TRACKER, places)
    V = np.zeros((24, 3, 24, 3))
    for i in range(24):
        V[i, :, i, :] = own[i]
        for j in range(24):
            if i == j or (zero == "shared" and i // 3 == j // 3):
                V[i, :, j, :] += own[i]
    V = V.reshape(72, 72)
    whitener = NoiseModel(1e-5, zero=zero).whitener(m)  # type: ignore[arg-type]
    x = RNG.normal(size=(24, 3, 5)) * 1e-5
    white, flat = whitener.apply(x), x.reshape(72, 5)
    np.testing.assert_allclose(white.T @ white, flat.T @ np.linalg.solve(V, flat), rtol=1e-9)
    assert whitener.logdet == pytest.approx(np.linalg.slogdet(V)[1], rel=1e-12)
    part = m.select(np.arange(24) % 2 == 0)  # the rays go with their rows
    np.testing.assert_array_equal(part.along, m.along[::2])


def test_a_row_that_lacks_an_axis_keeps_to_the_axes_of_the_base() -> None:
    m = readings(zero="separate", noise=NoiseStatement(instrument=TRACKER))
    moved = m.displacement.copy()
    moved[4, 1] = np.nan
    places = np.repeat(POINTS[:8], 3, axis=0)
    m = seen_from(replace(m, displacement=moved), places)
    white = NoiseModel(1e-5, zero="separate").whitener(m).apply(np.ones((24, 3)))
    assert white.shape == (71,)
    assert np.isfinite(white).all()
    found = white[12:14]
    np.testing.assert_allclose(found, 1.0 / np.sqrt(2.0) / m.sigma[4, [0, 2]], rtol=1e-12)


def written(folder: Path, noise: str, more: str = "", cells: str = "") -> Path:
    """Eight poses of the Motoman under one load."""
    head = ["joint_1_s", "joint_2_l", "joint_3_u", "joint_4_r", "joint_5_b", "joint_6_t"]
    rows = [
        "pose,"
        + ",".join(f"{j}[deg]" for j in head)
        + f",fx[N],fy[N],fz[N],dx[um],dy[um],dz[um]{more}"
    ]
    for k in range(8):
        joints = np.round(RNG.uniform([-60, -20, -20, -60, -60, -60], [60, 30, 20, 60, 60, 60]), 3)
        for load in (200, 400):
            moved = ",".join(f"{v:.1f}" for v in RNG.normal(size=3) * 300)
            rows.append(f"{k},{','.join(map(str, joints))},0,0,-{load},{moved}{cells}")
    file = folder / "data.csv"
    file.write_text("\n".join(rows) + "\n")
    file.with_suffix(".yaml").write_text(f"displacement: {{frame: base, zero: separate}}\n{noise}")
    return file


STATED = (
    "noise:\n  unit: um\n  instrument: {xyz: [3400, -2700, 900], unit: mm, along: 4, across: 9, "
    "across_per_m: 3}\n"
)


def test_an_instrument_is_stated_read_and_written(tmp_path: Path) -> None:
    read = sk.read(written(tmp_path, STATED))
    assert read.noise.instrument is not None
    np.testing.assert_allclose(read.noise.instrument.place, TRACKER.place)
    assert read.noise.instrument.across_per_m == pytest.approx(3e-6)
    again = sk.read(sk.write_measurements(read, tmp_path / "again.csv", length="um"))
    assert again.noise.instrument == pytest.approx(read.noise.instrument) or (
        again.noise.instrument == read.noise.instrument
    )
    robot = sk.load_robot("motoman_sk120")
    seen = as_seen(robot, read)
    points = robot.screws(read.joints, point=read.point).position
    np.testing.assert_allclose(seen.sigma, sigmas(read.noise.instrument, points), rtol=1e-12)
    found = sk.fit(sk.base_model(robot), read)
    assert "(3.40, -2.70, 0.90) m, with 4 µm along its ray" in " ".join(found.reasons)
    assert found.sigma_known  # what was stated is the yardstick


def test_told_uncertainties_are_the_yardstick_and_the_ray_is_told(tmp_path: Path) -> None:
    robot = sk.load_robot("motoman_sk120")
    plain = sk.read(written(tmp_path, STATED))
    points = robot.screws(plain.joints, point=plain.point).position
    told = replace(plain, noise=NoiseStatement(), sigma=sigmas(TRACKER, points))
    seen = as_seen(robot, told)
    np.testing.assert_array_equal(seen.sigma, told.sigma)
    assert [SEEN in note for note in seen.notes].count(True) == 1
    assert as_seen(robot, seen) is seen
    reasons = " ".join(sk.fit(sk.base_model(robot), told).reasons)
    assert "(3.40, -2.70, 0.90) m" in reasons


@pytest.mark.parametrize(
    ("noise", "more", "cells", "said"),
    [
        (STATED + "  sigma: 10\n", "", "", "both a standard uncertainty and an instrument"),
        (STATED, ",sx[um],sy[um],sz[um]", ",5,5,5", "that state none of their own"),
        (STATED.replace("along: 4, ", ""), "", "", "along"),
        (STATED.replace("  unit: um\n", ""), "", "", "unit"),
        (STATED.replace("along: 4", "along: -4"), "", "", "along"),
    ],
)
def test_what_does_not_fit_is_refused(
    tmp_path: Path, noise: str, more: str, cells: str, said: str
) -> None:
    with pytest.raises(InputError, match=said):
        sk.read(written(tmp_path, noise, more, cells))


def test_displacements_in_tool_axes_have_no_ray() -> None:
    m = readings(noise=NoiseStatement(instrument=TRACKER), displacement_frame="tool")
    with pytest.raises(InputError, match="in axes of the tool"):
        seen_from(m, np.repeat(POINTS[:8], 3, axis=0))
    told = readings(
        sigma=sigmas(TRACKER, np.repeat(POINTS[:8], 3, axis=0)), displacement_frame="tool"
    )
    assert np.isnan(seen_from(told, np.repeat(POINTS[:8], 3, axis=0)).along).all()


def test_springs_come_out_sharper_and_their_errors_hold() -> None:
    """Noise is drawn from whole covariances; told are its sizes per axis alone."""
    model = sk.base_model(sk.load_robot("motoman_sk120"))
    plan = sk.plan(model, 12, point=[-0.06, 0.04, 0.15], seed=3)
    exact = sk.simulate(model, plan).measurements
    assert exact.displacement is not None
    points = model.robot.screws(exact.joints, point=exact.point).position
    sharp = replace(TRACKER, along=1.5e-6, across=12e-6)
    roots = np.linalg.cholesky(covariances(sharp, points))
    alike = replace(
        exact, sigma=sigmas(sharp, points), noise=NoiseStatement(), zero="separate",
        zero_group=np.arange(exact.n_readings),
    )  # fmt: skip
    rng = np.random.default_rng(11)
    off: dict[bool, list[np.ndarray]] = {True: [], False: []}
    errors: dict[bool, np.ndarray] = {}
    truth = model.values[model.free]
    for _ in range(40):
        error = np.sqrt(2.0) * (roots @ rng.normal(size=(exact.n_readings, 3, 1)))[..., 0]
        drawn = replace(alike, displacement=exact.displacement + error)
        for seen in (True, False):
            independent = replace(drawn, along=np.full(error.shape, np.nan))
            found = sk.fit(model, drawn if seen else independent)
            errors[seen] = np.sqrt(np.diag(found.covariance))
            off[seen].append((found.x - truth / found.problem.scale) / errors[seen])
    assert np.all(errors[True] < 0.9 * errors[False])
    assert np.sqrt(np.mean(np.square(off[True]))) == pytest.approx(1.0, abs=0.12)


def test_a_noise_model_states_its_size_too() -> None:
    assert readings(noise=NoiseModel(5e-6, 0.01)).noise == NoiseStatement(5e-6, 0.01)
