"""Positions along the instrument's rays: read, written, weighed as they should be."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.errors import InputError
from sk120stiff.identify.positions.calibrate import Calibration, calibrate
from sk120stiff.identify.positions.residuals.line_of_sight import by_line_of_sight
from tests.positions.arm import NAMES, errors, poses, tracked, urdf, write

ALONG, ACROSS = 2e-4, 2e-5  # m: a camera knows least of all how far away things are
UNKNOWN = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
RAYS = "noise: {unit: um, instrument: {along: 200, across: 20}}\n"
DULL = f"noise: {{unit: um, sigma: {1e6 * np.sqrt((ALONG**2 + 2 * ACROSS**2) / 3):.6g}}}\n"


def seen(seed: int, count: int = 40) -> tuple[np.ndarray, np.ndarray]:
    """Joints (N, 6), and positions (N, 3) in axes of a camera 3 m away, with its noise."""
    a, rng = poses(count, seed), np.random.default_rng(seed)
    x = errors(seed).stands(a)[0]
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn[:, 0] *= np.sign(np.linalg.det(turn))
    x = x @ turn.T + 3.0 * turn[:, 2]
    ray = x / np.linalg.norm(x, axis=1, keepdims=True)
    error = ACROSS * rng.normal(size=x.shape)
    error += (ALONG - ACROSS) * (rng.normal(size=x.shape) * ray).sum(1, keepdims=True) * ray
    return a, x + error


def written(folder: Path, seed: int, noise: str) -> Path:
    a, x = seen(seed)
    (folder / "six.urdf").write_text(urdf())
    head = ",".join(["pose", *(f"{name}[rad]" for name in NAMES), "x[m]", "y[m]", "z[m]"])
    rows = [
        ",".join([f"p{k}", *map(repr, map(float, (*q, *at)))])
        for k, (q, at) in enumerate(zip(a, x, strict=True))
    ]
    (folder / "seen.csv").write_text("\n".join([head, *rows]) + "\n")
    (folder / "seen.yaml").write_text(f"robot: six.urdf\ntool_frame: tool\n{UNKNOWN}{noise}")
    return folder / "seen.csv"


def fitted(path: Path) -> Calibration:
    robot = sk.load_robot(path.parent / "six.urdf", base="base", tool="tool")
    return calibrate(sk.base_model(robot), sk.read(path).with_joints(NAMES), waves=False)


def test_rows_are_told_along_their_rays_and_written_back(tmp_path: Path) -> None:
    data = sk.read(written(tmp_path, 1, RAYS))
    channels = data.absolute.channels
    position = channels.position
    ray = position / np.linalg.norm(position, axis=1, keepdims=True)
    np.testing.assert_allclose(channels.rays[:, 0], ray)
    np.testing.assert_allclose(
        channels.rays @ channels.rays.swapaxes(1, 2), np.tile(np.eye(3), (40, 1, 1)), atol=1e-12
    )
    np.testing.assert_allclose(channels.sigma_of_rows, np.tile([ALONG, ACROSS, ACROSS], (40, 1)))
    again = sk.read(sk.write_measurements(data, tmp_path / "again.csv"))
    np.testing.assert_allclose(again.absolute.channels.rays, channels.rays, atol=1e-9)
    np.testing.assert_allclose(again.absolute.channels.sigma_of_rows, channels.sigma_of_rows)
    one = channels.select(np.array([3]))
    gap, slope = one.project(position[[3]] - 1e-3 * ray[[3]], np.eye(3)[None], np.ones((1, 6, 2)))
    np.testing.assert_allclose(gap, [1e-3, 0.0, 0.0], atol=1e-15)
    assert slope.shape == (3, 2)


def test_a_blank_cell_leaves_the_others(tmp_path: Path) -> None:
    path = written(tmp_path, 3, RAYS)
    whole = fitted(path)
    lines = path.read_text().splitlines()
    cells = lines[7].split(",")
    lines[7] = ",".join([*cells[:-3], "", *cells[-2:]])
    path.write_text("\n".join(lines) + "\n")
    blank = fitted(path)
    assert len(blank.residual) == len(whole.residual) - 1
    for name in ("j2", "j3"):
        one, other = (
            found.model.parameter(f"joint_springs:{name}.stiffness") for found in (whole, blank)
        )
        assert abs(one.internal - other.internal) < one.internal_std


def test_springs_are_known_better_and_as_well_as_is_said(tmp_path: Path) -> None:
    """The same readings, weighed along their rays and as if all axes were alike."""
    off: list[float] = []
    errs: dict[str, list[float]] = {RAYS: [], DULL: []}
    for seed in range(8):
        for noise, told in errs.items():
            found = fitted(written(tmp_path, seed, noise))
            true = errors(seed).compliance
            for p in found.parameters:
                if not p.effect.joint_spring or p.effect.where not in ("j2", "j3"):
                    continue
                told.append(p.internal_std or np.inf)
                if noise == RAYS:
                    off.append((p.internal - true[NAMES.index(p.effect.where)]) / told[-1])
    assert len(off) == 16 and np.median(errs[RAYS]) < 0.5 * np.median(errs[DULL])
    assert 0.6 < np.sqrt(np.mean(np.square(off))) < 1.4


def test_a_camera_that_nobody_stated_is_seen(tmp_path: Path) -> None:
    said = by_line_of_sight(fitted(written(tmp_path, 5, "")))
    assert len(said) == 1 and "along the line of sight" in said[0]
    told = re.search(r"along: ([\d.]+), across: ([\d.]+)", said[0])
    assert told is not None
    assert 100.0 < float(told[1]) < 250.0 and 15.0 < float(told[2]) < 60.0  # some goes to geometry
    assert by_line_of_sight(fitted(written(tmp_path, 5, RAYS))) == []
    a, x = poses(40, 5), tracked(errors(5).stands(poses(40, 5))[0])
    x = x + 3e-5 * np.random.default_rng(1).normal(size=x.shape)
    even = write(tmp_path, a, x, UNKNOWN)
    assert by_line_of_sight(fitted(even)) == []


def test_a_plan_of_more_has_no_rays_of_the_old_places(tmp_path: Path) -> None:
    data = sk.read(written(tmp_path, 2, RAYS)).with_joints(NAMES)
    (tmp_path / "strong.urdf").write_text(urdf().replace('effort="1"', 'effort="9000"'))
    robot = sk.load_robot(tmp_path / "strong.urdf", base="base", tool="tool")
    made = sk.plan_positions(sk.base_model(robot), 5, known=data, candidates=20)
    assert made.absolute.channels.rays is None and made.noise.instrument is not None
    again = sk.read(sk.write_measurements(made, tmp_path / "next.csv"))
    assert again.is_plan and again.noise.instrument == made.noise.instrument
    assert made.standard == pytest.approx(np.sqrt((ALONG**2 + 2 * ACROSS**2) / 3))


@pytest.mark.parametrize(
    ("settings", "why"),
    [
        (
            UNKNOWN
            + "noise: {unit: um, instrument: {xyz: [1, 0, 0], unit: m, along: 9, across: 2}}\n",
            "own axes",
        ),
        (
            "point: {xyz: [0, 0, 0], unit: mm, fit: true}\n" + RAYS,
            "nothing says where the instrument stands",
        ),
        (
            UNKNOWN + "noise: {sigma: 3, unit: um, instrument: {along: 9, across: 2}}\n",
            "both a standard",
        ),
    ],
)
def test_what_does_not_fit_together_is_told(tmp_path: Path, settings: str, why: str) -> None:
    path = written(tmp_path, 1, "")
    path.with_suffix(".yaml").write_text(f"robot: six.urdf\ntool_frame: tool\n{settings}")
    with pytest.raises(InputError, match=why):
        sk.read(path)
