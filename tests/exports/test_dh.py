"""DH tables, read back by a plain product of rotations and shifts, and their standard errors."""

import csv
import io
from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.exports import Exported
from sk120stiff.model import Model, Uncertainty, base_model
from sk120stiff.robot import Robot, load_robot
from tests.exports.arms import PUBLIC, exported, miscalibrated, public, standing, with_random
from tests.oracles.numpy_kinematics import rotation, transform

X, Y, Z = np.eye(3)
COLUMNS = ("theta[deg]", "d[mm]", "a[mm]", "b[mm]", "alpha[deg]", "beta[deg]")


def rows_of(made: Exported, convention: str) -> list[dict[str, str]]:
    rows = csv.DictReader(io.StringIO(made.text))
    return [row for row in rows if row["convention"] == convention]


def numbers(row: dict[str, str], prefix: str = "") -> np.ndarray:
    cells = np.array([float(row[prefix + name] or "nan") for name in COLUMNS])
    return cells * np.where([name.endswith("[deg]") for name in COLUMNS], np.pi / 180, 1e-3)


def product(made: Exported, convention: str, robot: Robot, pose: np.ndarray) -> np.ndarray:
    values = dict(zip(robot.actuated, pose, strict=True))
    T = np.eye(4)
    for row in rows_of(made, convention):
        theta, d, a, b, alpha, beta = numbers(row)
        q = float(row["factor"]) * values[row["driver"]] if row["driver"] else 0.0
        theta, d = (theta + q, d) if row["moves"] == "theta" else (theta, d + q)
        first = transform([0, 0, d], rotation(Z, theta))
        second = transform([a, b, 0], rotation(X, alpha) @ rotation(Y, beta))
        modified = convention == "modified" and row["moves"]
        T = T @ second @ first if modified else T @ first @ second
    return T


@pytest.mark.parametrize("convention", ["standard", "modified"])
@pytest.mark.parametrize("name", [*PUBLIC, "tiago.urdf"])  # the last one's torso slides
def test_both_tables_place_the_arm_where_the_model_does(name: str, convention: str) -> None:
    model = miscalibrated(name)
    made = exported(model, "dh")
    a = np.random.default_rng(1).uniform(-2.0, 2.0, (5, model.robot.n))
    for pose, T in zip(a, standing(model, a), strict=True):
        found = product(made, convention, model.robot, pose)
        np.testing.assert_allclose(found, T, rtol=0.0, atol=1e-9)


def test_a_joint_that_is_held_stands_in_the_table_where_it_is_held() -> None:
    robot = load_robot(
        "motoman_sk120", lock={"joint_5_b": 0.4},
        actuated=["joint_1_s", "joint_2_l", "joint_3_u", "joint_4_r", "joint_6_t"],
    )  # fmt: skip
    model = with_random(base_model(robot), "joint_offset", "joint_frame")
    made, pose = exported(model, "dh"), np.array([0.1, -0.2, 0.3, 0.4, -0.5])
    for convention in ("standard", "modified"):
        found = product(made, convention, robot, pose)
        np.testing.assert_allclose(found, standing(model, pose[None])[0], rtol=0.0, atol=1e-9)


def test_the_nominal_panda_is_the_one_that_its_maker_prints() -> None:
    """Franka's modified table: d 333, 316, 384 mm; a 82.5, -82.5, 88 mm; α in quarters."""
    rows = rows_of(exported(base_model(public("panda.urdf")), "dh"), "modified")[1:8]
    found = np.array([numbers(row) for row in rows])
    np.testing.assert_allclose(found[:6, 1], [0.333, 0, 0.316, 0, 0.384, 0], atol=1e-9)
    np.testing.assert_allclose(found[:, 2], [0, 0, 0, 0.0825, -0.0825, 0, 0.088], atol=1e-9)
    quarters = np.array([0, -1, 1, 1, -1, 1, 1]) * np.pi / 2
    np.testing.assert_allclose(found[:, 4], quarters, atol=1e-9)
    np.testing.assert_allclose(found[:, [0, 3, 5]], 0.0, atol=1e-9)
    assert {row["form"] for row in rows} == {"DH"}


def test_axes_that_are_all_but_parallel_keep_small_numbers() -> None:
    """With plain DH numbers a turn of 1 µrad would throw d by metres, and say so of nothing."""
    model = base_model(public("ur5_robot.urdf"))
    tables = []
    for tilt in (0.0, 1e-6):
        turned = with_random(model, "joint_frame:elbow_joint")
        values = np.zeros(len(turned.values))
        values[: len(model.values)], values[-1] = model.values, tilt
        values[-3] = tilt
        made = exported(turned.with_values(values), "dh")
        tables.append(np.array([numbers(row) for row in rows_of(made, "standard")]))
    assert np.abs(tables[1] - tables[0]).max() < 3e-6
    made = exported(turned.with_values(values), "dh")
    forms = [row["form"] for row in rows_of(made, "standard")]
    assert forms == ["free", "DH", "Hayati", "Hayati", "DH", "DH", "DH", "free"]
    hayati = [note for note in made.notes if "Hayati" in note]
    assert len(hayati) == 2 and "shoulder_lift_joint and elbow_joint" in hayati[0]


def known(model: Model, directions: np.ndarray, unseen: np.ndarray) -> Model:
    """The model, uncertain along directions (k, P) and blind along others."""
    covariance = directions.T @ directions
    return model.known(
        Uncertainty(model.names, model.values, covariance, unseen, noise=2e-5, freedom=20.0)
    )


@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_standard_errors_are_those_of_the_parameters(convention: str) -> None:
    """Against tables made of models that stand one standard error away, each way."""
    model = with_random(
        base_model(public("ur5_robot.urdf")), "joint_frame", "joint_offset", "tool_offset"
    )
    rng = np.random.default_rng(7)
    geometric = np.array([p.effect.name != "joint_springs" for p in model.parameters])
    directions = 1e-5 * rng.standard_normal((3, len(model.values))) * geometric
    made = exported(known(model, directions, np.zeros((0, len(model.values)))), "dh")
    squares: np.ndarray = np.zeros(())
    for along in directions:
        up, down = (
            np.array([numbers(row) for row in rows_of(exported(one, "dh"), convention)])
            for one in (model.with_values(model.values + s * along) for s in (1.0, -1.0))
        )
        squares = squares + (0.5 * (up - down)) ** 2
    found = np.array([numbers(row, "std_") for row in rows_of(made, convention)])
    assert (np.sqrt(squares) > 1e-6).sum() > 25
    asked = np.ones(found.shape, bool)
    asked[-2, 2:] = False  # where the flange sits behind the last joint nobody estimated
    assert (np.isfinite(found) == asked).all() and squares[~asked].max() < 1e-30
    np.testing.assert_allclose(found[asked], np.sqrt(squares)[asked], rtol=2e-3, atol=1e-11)
    assert made.details["coverage_factor_95"] == pytest.approx(2.086, abs=1e-3)


def test_what_the_readings_do_not_show_has_no_standard_error() -> None:
    model = with_random(base_model(public("ur5_robot.urdf")), "joint_offset")
    zero = np.zeros((1, len(model.values)))
    blind = zero.copy()
    blind[0, model.names.index("joint_offset:shoulder_pan_joint.offset")] = 0.02
    made = exported(known(model, zero, blind), "dh")
    table = {row["joint"]: row for row in rows_of(made, "standard")}
    assert table["shoulder_pan_joint"]["std_theta[deg]"] == ""
    assert float(table["elbow_joint"]["std_theta[deg]"]) == 0.0
    assert any("do not show" in note for note in made.notes)


@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_what_nobody_estimated_has_no_standard_error(convention: str) -> None:
    """Of the zero of one joint alone: nothing is known of other numbers."""
    model = with_random(base_model(public("ur5_robot.urdf")), "joint_offset:elbow_joint")
    P = len(model.values)
    known_well = 1e-5 * np.eye(P)[[model.names.index("joint_offset:elbow_joint.offset")]]
    made = exported(known(model, known_well, np.zeros((0, P))), "dh")
    table = {row["joint"]: numbers(row, "std_") for row in rows_of(made, convention)}
    elbow = table.pop("elbow_joint")
    assert elbow[0] == pytest.approx(1e-5)
    assert np.isnan(elbow[[2, 4, 5]]).all(), "nobody asked for lengths and tilts"
    for joint in ("base", "shoulder_pan_joint", "wrist_2_joint", "wrist_3_joint", "tool"):
        assert np.isnan(table[joint]).all(), joint
    assert any("was not estimated" in note for note in made.notes)


@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_a_number_that_is_zero_is_written_as_zero(convention: str) -> None:
    made = exported(base_model(public("ur5_robot.urdf")), "dh")
    table = np.array([numbers(row) for row in rows_of(made, convention)])
    assert not ((table != 0.0) & (np.abs(table) < 1e-14)).any()


def test_no_uncertainty_no_errors() -> None:
    model = replace(miscalibrated("ur5_robot.urdf"), uncertainty=None)
    made = exported(model, "dh")
    assert "std_" not in made.text.splitlines()[0]
    assert any("stores no uncertainty" in note for note in made.notes)
