"""Positions in every form in which they are taken: springs come out as from whole positions."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import sk120stiff as sk
from sk120stiff.errors import InputError
from sk120stiff.explain.positions.run import explain_positions
from sk120stiff.identify.positions.calibrate import Calibration, calibrate
from sk120stiff.identify.positions.words import gap_sentence, known_calibration
from sk120stiff.model import Model, write_model
from tests.positions.arm import NAMES, TURN, Arm, Array, G, errors, poses, tracked, write

SIGMA = 2e-5
FIT = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
NOISE = "noise: {sigma: 20, unit: um}\n"
FINE = 5e-6  # m; what a ball bar or an interferometer does
FINELY = "noise: {sigma: 5, unit: um}\n"
A = poses(80, 2)
RNG = np.random.default_rng(3)


def calibrated(path: Path) -> Calibration:
    data = sk.read(path)
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    return calibrate(sk.base_model(robot), data.with_joints(robot.actuated))


def agrees(found: Calibration, share: float = 0.05) -> None:
    """The second joint's spring is right within its error, known to `share`, and the noise is."""
    assert found.misfit[2] > 1e-3, found.noise_factor
    spring = found.model.parameter("joint_springs:j2.stiffness")
    assert abs(spring.internal - 1 / 8e5) < 3.5 * spring.internal_std
    assert spring.internal_std < share * spring.internal
    assert abs(spring.internal * 8e5 - 1.0) < 0.05  # full readings give it to a third of a percent


def noisy(x: Array) -> Array:
    return x + SIGMA * RNG.normal(size=x.shape)


def rows(numbers: Array) -> list[str]:
    return [",".join(f"{v:.10g}" for v in np.atleast_1d(row)) for row in numbers]


def test_blank_cells_are_channels_that_were_not_read(tmp_path: Path) -> None:
    x = noisy(tracked(errors(1).stands(A)[0]))
    x[RNG.random(x.shape) < 0.15] = np.nan
    found = calibrated(write(tmp_path, A, x, FIT + NOISE))
    agrees(found)
    assert len(found.residual) == np.isfinite(x).sum()


@pytest.mark.parametrize("quaternion", [False, True])
def test_rotations_beside_positions(tmp_path: Path, quaternion: bool) -> None:
    x, axes = errors(1).stands(A)
    turned = Rotation.from_rotvec(2e-5 * RNG.normal(size=x.shape)) * Rotation.from_matrix(
        TURN.as_matrix() @ axes
    )
    more, cells = ",rx[rad],ry[rad],rz[rad]", rows(turned.as_rotvec())
    if quaternion:
        more, cells = ",qw,qx,qy,qz", rows(np.roll(turned.as_quat(), 1, axis=1))
    settings = "noise: {sigma: 20, unit: um, rotation: 20, rotation_unit: urad}\n"
    found = calibrated(
        write(tmp_path, A, noisy(tracked(x)), FIT + settings, more=more, cells=cells)
    )
    agrees(found, 0.006)


def test_rotations_tell_what_positions_leave_open(tmp_path: Path) -> None:
    """A last joint whose marker lies on its axis: where it stands, only the tool's axes show."""
    arm = errors(1)
    arm.marker = np.array([0.05, 0.0, 0.0])
    x, axes = arm.stands(A)
    vectors = rows(Rotation.from_matrix(TURN.as_matrix() @ axes).as_rotvec())
    x = noisy(tracked(x))
    alone = calibrated(write(tmp_path, A, x, FIT + NOISE))
    more = ",rx[rad],ry[rad],rz[rad]"
    both = calibrated(write(tmp_path, A, x, FIT, more=more, cells=vectors))
    frozen = [{item.name for item in found.frozen} for found in (alone, both)]
    assert "joint_frame:j6.rz" in frozen[0] - frozen[1]
    assert frozen[1] < frozen[0]


def test_markers_series_and_payloads(tmp_path: Path) -> None:
    places = {"A": [0.05, -0.08, 0.12], "B": [-0.06, 0.03, 0.1]}
    names = RNG.choice(["A", "B"], len(A))
    x = np.array([_with(marker=places[n]).stands(A[k : k + 1])[0][0] for k, n in enumerate(names)])
    x = noisy(tracked(x))
    points = "points: {A: {xyz: [50, -80, 120], unit: mm}, B: {xyz: [-60, 30, 100], unit: mm}}\n"
    settings = "position: {frame: unknown}\n" + points + NOISE
    agrees(calibrated(write(tmp_path, A, x, settings, more=",marker", cells=list(names))))
    rough = settings.replace("mm}", "mm, fit: true}").replace("50, -80", "48, -79")
    agrees(calibrated(write(tmp_path, A, x, rough, more=",marker", cells=list(names))))
    swapped = [{"A": "B", "B": "A"}[n] for n in names]
    with pytest.raises(InputError, match="2 markers look exchanged"):
        calibrated(write(tmp_path, A, x, settings, more=",marker", cells=swapped))


def test_a_marker_mounted_anew(tmp_path: Path) -> None:
    series = np.repeat(["one", "two"], len(A) // 2)
    moved = {"one": [0.05, -0.08, 0.12], "two": [0.0508, -0.0805, 0.1203]}
    x = np.array([_with(marker=moved[n]).stands(A[k : k + 1])[0][0] for k, n in enumerate(series)])
    found = calibrated(
        write(tmp_path, A, noisy(tracked(x)), FIT + NOISE, more=",series", cells=list(series))
    )
    agrees(found)
    shift = [found.model.parameter(f"marker_shift:tool.two.{axis}").value for axis in "xyz"]
    assert shift == pytest.approx([8e-4, -5e-4, 3e-4], abs=5e-5)


@pytest.mark.parametrize("doubted", [False, True])
def test_payloads_bend_the_arm_where_they_hang(tmp_path: Path, doubted: bool) -> None:
    """Not where the marker is; a wrong centre is found from the sag."""
    mass, centre = RNG.choice([0.0, 20.0, 50.0], len(A)), np.array([0.0, 0.0, 0.12])
    x = np.array(
        [_with(payload=(m, centre)).stands(A[k : k + 1])[0][0] for k, m in enumerate(mass)]
    )
    settings = FIT + NOISE + "payload: {point: {xyz: [0, 0, 120], unit: mm}, fit: %s}\n"
    found = calibrated(
        write(
            tmp_path, A, noisy(tracked(x)), settings % str(doubted).lower(),
            more=",payload[kg]", cells=rows(mass),
        )
    )  # fmt: skip
    agrees(found, 0.01)


def test_distances_to_fixed_points_alone(tmp_path: Path) -> None:
    x = errors(1).stands(A)[0]
    anchors = np.array([[2.0, 1, 0.5], [1.5, -2, 0], [0, 2.5, 1], [-1, -2, 1.5]])[np.arange(80) % 4]
    far = np.linalg.norm(x - anchors, axis=1) + FINE * RNG.normal(size=80)
    found = calibrated(
        write(
            tmp_path, A, np.full_like(x, np.nan),
            "point: {xyz: [50, -80, 120], unit: mm}\n" + FINELY,
            more=",l[mm],ax[m],ay[m],az[m]", cells=rows(np.column_stack([1e3 * far, anchors])),
        )
    )  # fmt: skip
    agrees(found)


def test_a_dial_gauge_reads_one_direction(tmp_path: Path) -> None:
    path = write(tmp_path, A, errors(1).stands(A)[0], FIT)
    robot = sk.load_robot(str(tmp_path / "six.urdf"), base="base", tool="tool")
    force = 400.0 * RNG.normal(size=(80, 3))
    moved = sk.joint_spring_model(robot, 1 / errors(1).compliance).deflect(
        A, np.column_stack([force, np.zeros((80, 3))]), point=[0.05, -0.08, 0.12]
    )
    along = RNG.normal(size=(80, 3))
    along /= np.linalg.norm(along, axis=1)[:, None]
    read = 1e3 * ((along * moved).sum(axis=1) + 1e-6 * RNG.normal(size=80))
    table = np.column_stack([np.degrees(A), force, read, along])
    header = ",".join(f"{n}[deg]" for n in NAMES) + ",fx[N],fy[N],fz[N],d[mm],ux,uy,uz"
    path.write_text("\n".join([header, *rows(table)]) + "\n")
    path.with_suffix(".yaml").write_text(
        "robot: six.urdf\nbase_frame: base\ntool_frame: tool\nforce: {frame: base}\n"
        "point: {xyz: [50, -80, 120], unit: mm}\nnoise: {sigma: 1, unit: um}\n"
    )
    agrees(calibrated(path), 0.005)
    # One number a row: gaps of a rigid arm have long tails, and no row of them is wild.
    explained = explain_positions(Model(robot), sk.read(path).with_joints(robot.actuated))
    named = {item.effect.id for item in explained.findings}
    assert {f"joint_springs:j{k}" for k in range(1, 6)} <= named
    assert not explained.final.wild.any()
    said = path.with_suffix(".yaml")
    said.write_text(f"{said.read_text()}displacement: {{zero: separate}}\n")
    apart = sk.read(path).absolute  # a zero reading of its own: two readings of the gauge
    assert apart is not None and np.isclose(apart.channels.sigma["shift"], np.sqrt(2.0) * 1e-6)


def test_columns_as_the_controller_has_them(tmp_path: Path) -> None:
    """Joint 3 measured against the floor, under a name of its own."""
    shown = A.copy()
    shown[:, 2] = -(A[:, 2] + A[:, 1])
    settings = FIT + NOISE + "joints: {j3: -(K3 + j2)}\n"
    path = write(tmp_path, shown, noisy(tracked(errors(1).stands(A)[0])), settings)
    path.write_text(path.read_text().replace("j3[deg]", "K3[deg]"))
    agrees(calibrated(path))


def _with(marker: list[float] | None = None, payload: tuple[float, Array] | None = None) -> Arm:
    """The arm with another marker, or with a mass hung on its tool."""
    arm = errors(1)
    if marker is not None:
        arm.marker = np.array(marker)
    if payload is not None:
        mass, centre = payload
        bare: Callable[[Array], tuple[Array, Array, Array]] = arm.pose

        def pose(q: Array) -> tuple[Array, Array, Array]:
            x, R, energy = bare(q)
            weight = G * np.reshape(mass, (-1, *(1,) * (q.ndim - 2)))
            return x, R, energy + weight * (x + R @ (centre - arm.marker))[..., 2]

        arm.pose = pose  # type: ignore[method-assign]
    return arm


LEVEL = np.array([[1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0]])  # of the tool
HEADER = ",inc[deg],vx,vy,vz"


def levelled(axes: Array, sigma: float) -> tuple[Array, Array]:
    """Angles above the horizon (N,) with noise, and the direction of the tool nearest to it."""
    each = np.arcsin(axes[:, 2, :])
    pick = np.argmin(np.abs(each), axis=1)
    angle = each[np.arange(len(axes)), pick] + sigma * RNG.normal(size=len(axes))
    return angle, LEVEL[pick]


def test_an_inclinometer_alone_gives_the_springs_that_full_readings_give(tmp_path: Path) -> None:
    """Geometry known; angles alone, base axes, no position at all."""
    arm = Arm(compliance=errors(1).compliance)
    x, axes = arm.stands(A)
    angle, level = levelled(axes, 5e-6)
    table = np.column_stack([np.degrees(angle), level])
    path = write(
        tmp_path, A, np.full_like(x, np.nan),
        "point: {xyz: [50, -80, 120], unit: mm}\n"
        "noise: {sigma: 20, unit: um, rotation: 5, rotation_unit: urad}\n",
        more=HEADER, cells=rows(table),
    )  # fmt: skip
    data = sk.read(path)
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    found = calibrate(
        sk.base_model(robot), data.with_joints(robot.actuated), geometry=False, waves=False
    )
    assert found.misfit[2] > 1e-3
    for k in (2, 3):
        spring = found.model.parameter(f"joint_springs:j{k}.stiffness")
        assert spring.value == pytest.approx(1.0 / arm.compliance[k - 1], rel=0.05)
        assert abs(spring.internal - arm.compliance[k - 1]) < 3.5 * spring.internal_std


def test_angles_against_gravity_sharpen_springs_beside_geometry(tmp_path: Path) -> None:
    x, axes = errors(1).stands(A)
    x = noisy(tracked(x))
    alone = calibrated(write(tmp_path, A, x, FIT + NOISE))
    angle, level = levelled(axes, 5e-6)
    cells = rows(np.column_stack([np.degrees(angle), level]))
    settings = "noise: {sigma: 20, unit: um, rotation: 5, rotation_unit: urad}\n"
    both = calibrated(write(tmp_path, A, x, FIT + settings, more=HEADER, cells=cells))
    agrees(both)
    std = [f.model.parameter("joint_springs:j3.stiffness").internal_std for f in (alone, both)]
    assert std[1] < 0.7 * std[0]


def test_inclinations_that_tell_nothing_are_refused(tmp_path: Path) -> None:
    x = tracked(errors(1).stands(A)[0])
    for cells, said in (("89,0,0,1", "89 deg"), ("10,0,0,0", "no direction")):
        path = write(tmp_path, A, x, FIT, more=HEADER, cells=[cells] * len(A))
        with pytest.raises(InputError, match=said):
            sk.read(path)
    path = write(tmp_path, A, x, FIT + "gravity: 0\n", more=HEADER, cells=["10,0,0,1"] * len(A))
    with pytest.raises(InputError, match="against gravity"):
        calibrated(path)


def test_rows_that_state_their_own_uncertainty(tmp_path: Path) -> None:
    sizes = RNG.choice([1e-5, 3e-5], A.shape[:1] + (3,))
    x = tracked(errors(1).stands(A)[0]) + sizes * RNG.normal(size=sizes.shape)
    path = write(tmp_path, A, x, FIT, more=",sx[mm],sy[mm],sz[mm]", cells=rows(1e3 * sizes))
    found = calibrated(path)
    agrees(found)
    size = float(np.sqrt(np.mean(sizes**2)))
    assert found.problem.noise.sigma == pytest.approx(size)
    known = known_calibration(found).uncertainty
    assert known is not None and known.noise == pytest.approx(size)


def test_angles_alone_have_their_own_unit(tmp_path: Path) -> None:
    arm, level = errors(1), np.tile([0.0, 1.0, 0.0], (len(A), 1))
    up = (arm.stands(A)[1] @ [0.0, 1.0, 0.0])[:, 2]
    read = np.degrees(np.arcsin(up) + SIGMA * RNG.normal(size=len(A)))
    flat = np.abs(read) < 80.0
    cells = rows(np.column_stack([read, level])[flat])
    nothing = np.full((int(flat.sum()), 3), np.nan)
    settings = "noise: {rotation: 20, rotation_unit: urad}\n"
    more = ",inc[deg],vx,vy,vz"
    path = write(tmp_path, A[flat], nothing, settings, more=more, cells=cells)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        said = gap_sentence(calibrated(path))
    assert "µrad rms of angles" in said and "nan" not in said
    data = sk.read(path)
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    readings = data.with_joints(robot.actuated)
    answer = explain_positions(Model(robot), readings)
    told = answer.document().as_keys()
    assert told["gap"]["unit"] == "urad" and told["remainder"]["rms_um"] is None
    assert told["gap"]["steps"][0]["heldout_rms"] > 50.0
    assert "µm" not in " ".join(answer.left_over())
    known = known_calibration(answer.final)
    write_model(known, tmp_path / "model.yaml")
    again = sk.read_model(tmp_path / "model.yaml").uncertainty
    assert again is not None and again.noise is None and again.floor > 0.0


def test_markers_of_which_no_place_is_known(tmp_path: Path) -> None:
    places = {"A": [0.05, -0.08, 0.12], "B": [-0.06, 0.2, 0.1], "C": [0.3, 0.03, -0.1]}
    names = RNG.choice(list(places), len(A))
    x = np.array([_with(marker=places[n]).stands(A[k : k + 1])[0][0] for k, n in enumerate(names)])
    x = noisy(tracked(x))
    found = calibrated(write(tmp_path, A, x, FIT + NOISE, more=",marker", cells=list(names)))
    agrees(found, 0.06)
    first = dict.fromkeys(names)
    for name in list(first)[1:]:
        shift = np.subtract(places[name], places[next(iter(first))])
        for axis, true in zip("xyz", shift, strict=True):
            p = found.model.parameter(f"marker_shift:tool.{name}.{axis}")
            assert abs(p.value - true) < 5e-4  # the last frame's own turn is counted in it
    radians = write(tmp_path, np.radians(A), x, FIT + NOISE, more=",marker", cells=list(names))
    with pytest.raises(InputError, match="radians, not degrees"):
        calibrated(radians)
