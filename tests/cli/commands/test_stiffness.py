"""`sk120stiff stiffness`: its JSON against closed forms, and what it refuses."""

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.effects import effect
from sk120stiff.model import Parameter, base_model, joint_spring_model, write_model
from sk120stiff.robot import load_robot
from tests.corpus.robots import example
from tests.positions.test_payload_place import hung, robot_of

UPPER, FORE = 0.5, 0.4  # m
K_1, K_2 = 2.0e5, 1.0e5  # N·m/rad
POSE = ("--pose", "30, -50 deg")
LOAD = ("--wrench", "1200, -900, 0 N")
PUSH = ("--wrench", "0, 0, -300 N")

URDF = f"""
<robot name="two_links">
  <link name="ground"/><link name="upper"/><link name="fore"/><link name="tip"/>
  <joint name="shoulder" type="revolute"><parent link="ground"/><child link="upper"/>
    <axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="100" velocity="1"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/>
    <origin xyz="{UPPER} 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="100" velocity="1"/></joint>
  <joint name="end" type="fixed"><parent link="fore"/><child link="tip"/>
    <origin xyz="{FORE} 0 0"/></joint>
</robot>
"""
MODEL = """
robot: two_links.urdf
effects:
  - name: joint_springs
    where: shoulder
    parameters: {{stiffness: {{value: {}, unit: N*m/rad}}}}
  - name: joint_springs
    where: elbow
    parameters: {{stiffness: {{value: {}, unit: N*m/rad}}}}
"""


@pytest.fixture
def two_links(tmp_path: Path) -> tuple[str, str]:
    (tmp_path / "two_links.urdf").write_text(URDF, encoding="utf-8")
    (tmp_path / "model.yaml").write_text(MODEL.format(K_1, K_2), encoding="utf-8")
    return str(tmp_path / "two_links.urdf"), str(tmp_path / "model.yaml")


def planar(theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Elbow seen from the tip and tip seen from the base, by trigonometry."""
    first, both = theta[0], theta.sum()
    fore = FORE * np.array([np.cos(both), np.sin(both)])
    return fore, UPPER * np.array([np.cos(first), np.sin(first)]) + fore


def turned(x: np.ndarray) -> np.ndarray:
    return np.array([-x[1], x[0]])


def test_a_planar_arm_by_hand(run, two_links) -> None:
    robot, model = two_links
    outcome = run("stiffness", robot, *POSE, *LOAD, "--model", model, "--json")
    assert outcome.code == 0, outcome.stderr
    found = outcome.document
    theta, force = np.deg2rad([30.0, -50.0]), np.array([1200.0, -900.0])
    fore, tip = planar(theta)
    J = np.column_stack([turned(tip), turned(fore)])
    # ∂(Jᵀ F)/∂θ of two parallel axes: every entry is minus a lever arm along the force
    K_C = -np.array([[tip @ force, fore @ force], [fore @ force, fore @ force]])
    K_theta = np.diag([K_1, K_2])
    np.testing.assert_allclose(found["pose"], theta, rtol=1e-15)
    np.testing.assert_allclose(np.array(found["jacobian"])[:2], J, atol=1e-14)
    np.testing.assert_allclose(np.array(found["jacobian"])[2:], [[0, 0]] * 3 + [[1, 1]], atol=1e-14)
    np.testing.assert_allclose(found["K_theta"], K_theta, rtol=1e-12)
    np.testing.assert_allclose(found["K_C"], K_C, rtol=1e-12)
    for kind, K in (("conventional", K_theta), ("enhanced", K_theta - K_C)):
        compliance = J @ np.linalg.solve(K, J.T)
        np.testing.assert_allclose(
            np.array(found["compliance"][kind])[:2, :2], compliance, rtol=1e-11
        )
        np.testing.assert_allclose(found["deflection"][kind][:2], compliance @ force, rtol=1e-11)
        assert found[f"K_X_{kind}"] is None  # nothing yields out of the plane
        assert found[f"K_X_6x6_{kind}"] is None
    values = found["principal_stiffness"]["values"]
    expected = np.linalg.eigvalsh(J @ np.linalg.solve(K_theta - K_C, J.T))[::-1]
    np.testing.assert_allclose(values[:2], 1.0 / expected, rtol=1e-10)
    assert values[2] is None
    np.testing.assert_allclose(
        np.abs(found["principal_stiffness"]["directions"][2]), [0, 0, 1], atol=1e-12
    )
    assert found["definiteness"]["K_theta_minus_K_C"] == "positive definite"


def test_the_equilibrium_balances(run, two_links) -> None:
    robot, model = two_links
    found = run("stiffness", robot, *POSE, *LOAD, "--model", model, "--json").document
    theta, force = np.deg2rad([30.0, -50.0]), np.array([1200.0, -900.0])
    loaded = theta.copy()
    for _ in range(100):  # a plain fixed point, not the program's Newton
        fore, tip = planar(loaded)
        loaded = theta + np.array([turned(tip) @ force / K_1, turned(fore) @ force / K_2])
    moved = planar(loaded)[1] - planar(theta)[1]
    np.testing.assert_allclose(found["deflection"]["equilibrium"][:2], moved, atol=1e-14)


def test_the_critical_factor_is_critical(run, two_links) -> None:
    robot, model = two_links
    pushed = ("--pose", "0,0 deg", "--wrench", "-1000,0,0 N", "--model", model, "--json")
    factor = run("stiffness", robot, *pushed).document["critical_load_factor"]
    lever = 1000.0 * np.array([[UPPER + FORE, FORE], [FORE, FORE]])  # K_C of the straight arm
    smallest = np.linalg.eigvals(np.linalg.solve(lever, np.diag([K_1, K_2]))).min()
    assert factor == pytest.approx(smallest, rel=1e-10)
    beyond = f"{-1001.0 * factor},0,0 N"
    document = run(
        "stiffness", robot, "--pose", "0,0 deg", "--wrench", beyond, "--model", model, "--json"
    ).document
    assert document["definiteness"]["K_theta_minus_K_C"] == "indefinite"
    pulled = ("--pose", "0,0 deg", "--wrench", "1000,0,0 N", "--model", model, "--json")
    assert run("stiffness", robot, *pulled).document["critical_load_factor"] is None


def test_the_sk120_obeys_its_own_formula(run) -> None:
    found = run(
        "stiffness",
        "motoman_sk120",
        "--pose",
        "10,20,-30,0,0,0 deg",
        "--wrench",
        "100,0,-200 N",
        "--json",
    ).document
    assert found["soft"] == ["joint_1_s", "joint_2_l", "joint_3_u"]
    assert found["K_theta"][3][3] is None  # the wrist is rigid in the paper's model
    inverse = np.linalg.inv(np.array(found["jacobian"])[:3, :3])
    K_theta = np.array([row[:3] for row in found["K_theta"][:3]])
    K_C = np.array(found["K_C"])[:3, :3]
    np.testing.assert_allclose(K_theta, np.diag([1.4098e6, 4.0076e5, 9.3528e5]), rtol=1e-12)
    for kind, K in (("conventional", K_theta), ("enhanced", K_theta - K_C)):
        np.testing.assert_allclose(found[f"K_X_{kind}"], inverse.T @ K @ inverse, rtol=1e-9)
    values, directions = found["principal_stiffness"].values()
    np.testing.assert_allclose(
        np.array(directions).T @ np.diag(values) @ np.array(directions),
        found["K_X_enhanced"],
        rtol=1e-9,
        atol=1e-3,
    )
    assert set(found["units"]) >= {"jacobian", "K_theta", "K_C", "deflection"}


def test_all_joints_at_zero_without_load(run) -> None:
    outcome = run("stiffness", "motoman_sk120", "--json")
    found = outcome.document
    assert outcome.code == 0, outcome.stderr
    assert found["pose"] == [0.0] * 6
    assert found["K_X_enhanced"] == found["K_X_conventional"]
    assert found["deflection"]["equilibrium"] == [0.0] * 3
    assert run("stiffness", "motoman_sk120").code == 0


def test_other_frames(run, two_links) -> None:
    """At the elbow only the shoulder bends; on the same body the point simply moves."""
    robot, model = two_links
    load = ("--wrench", "0, 1000, 0 N", "--model", model, "--json")
    found = run("stiffness", robot, "--pose", "0,0 deg", *load, "--at", "fore").document
    assert found["at"] == "fore"
    assert found["deflection"]["conventional"][1] == pytest.approx(1000.0 * UPPER**2 / K_1)
    sk120 = ("stiffness", "motoman_sk120", "--wrench", "100,0,-200 N", "--json")
    at_tool, at_reflector = (run(*sk120, "--at", f).document for f in ("tool0", "reflector"))
    assert at_tool["K_X_enhanced"] != at_reflector["K_X_enhanced"]
    rotation = np.array(at_tool["jacobian"])[3:], np.array(at_reflector["jacobian"])[3:]
    np.testing.assert_allclose(*rotation, atol=1e-12)


def test_defaults_are_said_aloud(run, two_links) -> None:
    robot, model = two_links
    outcome = run("stiffness", robot, "--model", model)
    assert "Base frame: ground" in outcome.stderr
    assert "Tool frame: tip" in outcome.stderr
    named = run("stiffness", robot, "--model", model, "--base", "ground", "--tool", "tip")
    assert "frame:" not in named.stderr
    assert "frame:" not in run("stiffness", "motoman_sk120").stderr


def test_the_other_arm_and_the_fingers_are_told(run) -> None:
    told = run("stiffness", str(example("baxter.urdf")))
    assert told.code == 0
    assert "Tool frame: right_hand_link (its name says so, behind 7 joints)" in told.stderr
    assert "ends also at left_hand_link (7)" in told.stderr
    assert "with --tool FRAME" in told.stderr
    assert "Held still as fingers: " in told.stderr
    assert "r_gripper_l_finger_joint" in told.stderr


@pytest.mark.parametrize(
    ("arguments", "hint"),
    [
        (("--pose", "10,20,30,0,0,0"), "--pose"),
        (("--pose", "10,20 deg"), "--pose"),
        (("--pose", "joint_7=20 deg"), "joint_2_l"),
        (("--pose", "10,20,-30,0,0,0 mm"), "unit"),
        (("--pose", "nan,0,0,0,0,0 deg"), "finite"),
        (("--wrench", "1,2 N"), "--wrench"),
        (("--wrench", "1,2,3 N*m"), "--wrench"),
        (("--wrench", "1,2,3,4,5,6 N"), "moments"),
        (("--at", "nowhere"), "--at: there is no frame 'nowhere'. Frames are: base_link, "),
        (("--tool", "nowhere"), "there is no frame 'nowhere'. Frames are: base_link, "),
        (("--base", "tol0"), "there is no frame 'tol0' (did you mean 'tool0'?)"),
        (("--model", "missing.yaml"), "missing.yaml"),
    ],
)
def test_bad_input(run, arguments, hint: str) -> None:
    outcome = run("stiffness", "motoman_sk120", *arguments, "--json")
    assert (outcome.code, outcome.answered) == (2, False)
    assert outcome.stderr.startswith("Error: ")
    assert len(outcome.stderr.splitlines()) == 1
    assert hint in outcome.stderr


def test_negative_numbers_may_come_first(run) -> None:
    outcome = run("stiffness", "motoman_sk120", "--pose", "-10,20,-30,0,0,0 deg", "--json")
    assert outcome.document["pose"][0] == pytest.approx(np.deg2rad(-10.0))


def test_a_robot_without_springs_gets_typical_ones_and_that_is_said(run, two_links) -> None:
    robot, _ = two_links
    outcome = run("stiffness", robot, "--json")
    assert outcome.code == 0
    (said,) = [text for text in outcome.document["warnings"] if "springs" in text]
    assert "typical of an arm of this size, not measured" in said
    assert "Identify them" in said and "--model" in said
    assert f"Warning: {said}" in outcome.stderr


def test_a_value_that_no_arm_has_is_told(run, tmp_path: Path) -> None:
    """A fit went astray, and every command would go on with it."""
    model = base_model(load_robot("motoman_sk120"))
    kind = effect(model.robot, "joint_offset", "joint_2_l")
    for size, told in ((0.02, False), (0.08, True)):
        file = tmp_path / f"{size}.yaml"
        write_model(model + [Parameter(kind, kind.parameters[0], size)], file)
        outcome = run("stiffness", str(file), "--json")
        said = [text for text in outcome.document["warnings"] if "plausible" in text]
        assert bool(said) == told
    assert said[0].startswith("More than is plausible: joint_offset:joint_2_l.offset = 0.08 rad.")


def test_a_load_that_nothing_can_hold(run, tmp_path: Path) -> None:
    """Springs of 10 N·m/rad against kilonewtons: the formulas answer, the equilibrium cannot."""
    arm = load_robot("motoman_sk120")
    soft = tmp_path / "soft.yaml"
    write_model(joint_spring_model(arm, np.full(6, 10.0)), soft)
    outcome = run(
        "stiffness",
        "motoman_sk120",
        "--model",
        str(soft),
        "--pose",
        "10,20,-30,40,50,60 deg",
        "--wrench",
        "3000,-2000,4000,3000,-5000,2000 N, N*m",
        "--json",
    )
    assert outcome.code == 0
    deflection = outcome.document["deflection"]
    assert deflection["equilibrium"] is None and deflection["enhanced"] is None
    assert "gives way at" in deflection["why_null"]["equilibrium"]
    assert "indefinite" in deflection["why_null"]["enhanced"]
    assert outcome.document["definiteness"]["K_theta_minus_K_C"] == "indefinite"
    assert outcome.stderr.startswith("Warning: no static equilibrium: followed from zero")
    assert len(outcome.stderr.splitlines()) == 1


def test_far_beyond_the_critical_load_one_number_says_how_far(run) -> None:
    """A kilotonne-force: just below the number that is said the pose holds, just above it not."""
    command = ("stiffness", "motoman_sk120", "--pose", "0,0,-90,0,90,0 deg")
    outcome = run(*command, "--wrench", "0,0,-1e9 N")
    assert outcome.code == 0
    factor = run(*command, "--wrench", "0,0,-1e9 N", "--json").document["critical_load_factor"]
    document = run(*command, "--wrench", f"0,0,{-1e9 * factor * 0.999} N", "--json").document
    assert document["definiteness"]["K_theta_minus_K_C"] == "positive definite"
    document = run(*command, "--wrench", f"0,0,{-1e9 * factor * 1.001} N", "--json").document
    assert document["definiteness"]["K_theta_minus_K_C"] != "positive definite"
    told = " ".join((outcome.stdout + outcome.stderr).split())
    assert f"becomes unstable at {factor:.4g} times this load" in told
    assert factor < 0.01 and "gives way at less than 0.01 of this load" in told
    assert "no place where the arm can be" in told
    assert "sk120stiff stiffness" not in told


def test_what_yields_under_the_load_alone_is_told_too(run, two_links, tmp_path: Path) -> None:
    """A floor that is rigid until it is loaded, on an arm without masses."""
    _, model = two_links
    stiffer = ", ".join(
        f"stiffness_{axis}_at_{load}: {{value: {value}, unit: N*m/rad}}"
        for axis in "xy"
        for load, value in ((0, ".inf"), (100, "1e6"))
    )
    held = tmp_path / "held.yaml"
    text = Path(model).read_text(encoding="utf-8")
    held.write_text(
        f"{text}  - {{name: base_rocking, where: ground, parameters: {{{stiffer}}}}}\n",
        encoding="utf-8",
    )
    loaded = run("stiffness", str(held), *POSE, *PUSH, "--json")
    assert loaded.document["soft"] == ["shoulder", "elbow"]
    (first, *_) = loaded.document["soft_under_load"]
    assert first.startswith("base_rocking:ground")
    said = run("stiffness", str(held), *POSE, *PUSH).stdout
    assert f"under this load also: {first}" in said
    unloaded = run("stiffness", str(held), *POSE, "--json").document
    assert unloaded["soft_under_load"] == []


def test_rounding_is_printed_as_zero(run) -> None:
    options = ("--pose", "0,-90,90,0,90,0 deg", "--wrench", "0,0,-50 N")
    assert "e-1" not in run("stiffness", "ur5e", *options).stdout


def test_what_is_not_known_of_a_deflection_is_no_zero(tmp_path: Path, run) -> None:
    path = hung(tmp_path, [0.0, 30.0, 60.0], "payload: {point: {xyz: [60, -40, 250], unit: mm}}\n")
    robot, data = robot_of(path), sk.read(path)
    sk.explain(sk.Model(robot), data).save(tmp_path)
    pose = ",".join(f"{angle:.4f}" for angle in data.joints[0])
    wrench = "0, 200, 0 N"
    told = run(
        "stiffness", str(tmp_path / "model.yaml"), "--pose", f"{pose} rad", "--wrench", wrench
    )
    assert told.code == 0, told.stderr
    (row,) = [line for line in told.stdout.splitlines() if "one standard deviation" in line]
    assert row.split()[-3:] == ["?", "?", "?"]
