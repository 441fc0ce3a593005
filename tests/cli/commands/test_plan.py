"""`sk120stiff plan`: files for the measurement, and what they promise."""

import re
from pathlib import Path

import numpy as np
import pytest

from sk120stiff.effects import effect
from sk120stiff.measurements import read_measurements
from sk120stiff.model import base_model, write_model
from sk120stiff.plan import NoWay, Pool
from sk120stiff.robot import load_robot
from tests.plan.test_cell import ARM

MODEL = "robots/motoman_sk120/model.yaml"
DATA = "robots/motoman_sk120/data/table2_measured.csv"
FEW = ("--candidates", "60", "--directions", "4")


def test_plan_simulate_identify(run, tmp_path: Path) -> None:
    """What the plan promises is what the identification finds."""
    plan, made = str(tmp_path / "plan.csv"), str(tmp_path / "made.csv")
    outcome = run("plan", "--model", MODEL, "--count", "12", *FEW, "--out", plan, "--json")
    assert outcome.code == 0, outcome.stderr
    found = outcome.document
    assert found["criterion"] == "D-optimal"
    assert len(found["poses"]) == 12
    assert set(found["poses"][0]) == {"pose", "joints", "wrench"}
    assert found["gain"] > 1.3
    assert found["gain_over_spread"] > 1.3
    assert read_measurements(plan).displacement is None
    run("simulate", MODEL, plan, "--noise", "10 um", "--zero", "separate", "--out", made)
    identified = run("identify", made, "--json").document["parameters"]
    for expected, parameter in zip(found["expected"], identified, strict=True):
        assert expected["name"] == parameter["name"]
        assert parameter["std"] == pytest.approx(expected["std"], rel=0.05)
    predicted = run("predict", MODEL, plan, "--json").document
    assert len(predicted["rows"]) == 12


def test_between_two_effects(run) -> None:
    options = ("--between", "link_bending:link_3_u,joint_tilt:joint_2_l", *FEW, "--json")
    found = run("plan", "--model", MODEL, "--count", "5", *options).document
    assert found["criterion"] == "T-optimal"
    assert found["between"] == ["link_bending:link_3_u", "joint_tilt:joint_2_l"]
    assert found["gain"] > 1.5
    assert found["evidence"] > found["evidence_before"] == 0.0
    with_data = run("plan", "--model", MODEL, "--count", "5", *options, "--data", DATA).document
    assert with_data["evidence"] > 0.0


def test_names_of_places_may_hold_commas(run) -> None:
    options = ("--between", "closure_coupling:joint_2_l,joint_3_u,closure_rod", *FEW, "--json")
    found = run("plan", "--model", MODEL, "--count", "3", *options).document
    assert found["between"][0] == "closure_coupling:joint_2_l,joint_3_u"


def test_for_some_parameters(run) -> None:
    options = ("--for", "base_rocking", "--for", "joint_springs:joint_1_s.stiffness")
    found = run("plan", "--model", MODEL, "--count", "4", *options, *FEW, "--json").document
    assert found["for"] == [
        "base_rocking:base_link.stiffness_x",
        "base_rocking:base_link.stiffness_y",
        "joint_springs:joint_1_s.stiffness",
    ]
    absent = found["expected"][0]
    assert absent["std"] is None
    assert absent["internal_std"] > 0.0
    assert absent["internal_unit"] == "rad/(N*m)"


def test_regions_loads_and_points(run, tmp_path: Path) -> None:
    out = tmp_path / "plan.csv"
    options = ("--lowest", "-500 mm", "--box", "0.5,-1.5,0, 3,1.5,2 m")
    options = (*options, "--force", "0.25 kN", "--point", "0,40,150 mm")
    outcome = run("plan", "--model", MODEL, "--count", "6", *options, *FEW, "--out", str(out))
    assert outcome.code == 0, outcome.stderr
    plan = read_measurements(out)
    np.testing.assert_allclose(plan.point, [0.0, 0.04, 0.15])
    np.testing.assert_allclose(np.linalg.norm(plan.wrench[:, :3], axis=1), 250.0)
    T = load_robot("motoman_sk120").placement(plan.joints)
    at = T[:, :3, :3] @ plan.point + T[:, :3, 3]
    assert np.all((at >= [0.5, -1.5, 0.0]) & (at <= [3.0, 1.5, 2.0]))


def test_points_and_noise_come_from_the_data(run, tmp_path: Path) -> None:
    out = tmp_path / "plan.csv"
    calculated = "robots/motoman_sk120/data/table2_calculated.csv"
    outcome = run(
        "plan", "--model", MODEL, "--count", "3", "--data", calculated, *FEW, "--out", str(out),
        "--json",
    )  # fmt: skip
    assert outcome.document["sigma_um"] == pytest.approx(0.0204)
    assert read_measurements(out).zero == "separate"


def test_seeds_decide(run) -> None:
    def poses(seed: str) -> object:
        options = ("--count", "3", *FEW, "--seed", seed, "--json")
        return run("plan", "--model", MODEL, *options).document["poses"]

    assert poses("1") == poses("1") != poses("2")


@pytest.mark.parametrize(
    ("options", "code", "hint"),
    [
        (("--between", "base_rocking"), 2, "--between"),
        (("--between", "base_rocking,base_rocking"), 2, "twice"),
        (("--between", "base_rocking,nonsense"), 2, "nonsense"),
        (("--for", "nonsense"), 2, "nonsense"),
        (("--for", "base_rocking:base_link.stiffness_q"), 2, "stiffness_q"),
        (("--force", "400"), 2, "unit"),
        (("--force", "-4 N"), 2, "positive"),
        (("--point", "1,2 mm"), 2, "--point"),
        (("--box", "1,2,3 m"), 2, "--box"),
        (("--box", "1,1,1,0,0,0 m"), 2, "inside"),
        (("--lowest", "20 m"), 1, "Lower the floor"),
        (("--count", "5000"), 2, "candidates"),
        (("--program", "way.txt"), 2, ".src (KUKA"),
        (("--program", "way.nc"), 2, "joint values"),
        (("--cell", "nowhere.yaml"), 2, "floor: -0.8 m"),
    ],
)
def test_bad_options(run, tmp_path: Path, options, code: int, hint: str) -> None:
    out = tmp_path / "plan.csv"
    outcome = run(
        "plan", "--model", MODEL, "--count", "4", *FEW, *options, "--out", str(out), "--json"
    )
    assert (outcome.code, outcome.answered) == (code, False)
    assert hint in outcome.stderr
    assert not out.exists()


def test_rows_are_checked_one_by_one(run, tmp_path: Path) -> None:
    """What was planned passes; what was measured outside the cell is told line by line."""
    cell = tmp_path / "cell.yaml"
    cell.write_text("floor: -1 m\nrig: {kind: weight, steps: '100, 300 N'}\n", encoding="utf-8")
    out = str(tmp_path / "plan.csv")
    options = ("--cell", str(cell), "--point", "0,40,150 mm")
    made = run("plan", "--model", MODEL, "--count", "4", *FEW, *options, "--out", out, "--json")
    assert made.code == 0 and made.document["cell"] == str(cell)
    found = run("plan", "--check", out, "--json")  # the cell beside the plan
    assert found.code == 0 and found.document["feasible"] == 4
    assert found.document["cell"] == str(cell)
    bad = run("plan", "--check", DATA, "--cell", str(cell), "--json")
    assert bad.code == 1 and bad.document["feasible"] == 0
    first = bad.document["rows"][0]
    assert first["line"] == 2 and any("weight" in fault for fault in first["faults"])
    assert run("plan", "--check", DATA).code == 0
    assert run("plan", "--count", "3").code == 2


def test_a_count_is_of_poses(run, tmp_path: Path) -> None:
    out = tmp_path / "plan.csv"
    options = ("--count", "4", "--loads", "3", *FEW, "--out", str(out), "--json")
    found = run("plan", "--model", MODEL, *options).document
    assert len(found["poses"]) == 12
    assert len({row["pose"] for row in found["poses"]}) == 4
    assert len(read_measurements(out).poses) == 4


def test_the_way_is_written_as_a_program(run, tmp_path: Path) -> None:
    out, program = tmp_path / "plan.csv", tmp_path / "way.src"
    options = ("--count", "4", *FEW, "--program", str(program), "--out", str(out), "--json")
    outcome = run("plan", "--model", MODEL, *options)
    assert outcome.code == 0, outcome.stderr
    way = outcome.document["route"]
    assert way["order"] == ["p1", "p2", "p3", "p4"]  # numbered as they are driven
    assert way["minutes"] == pytest.approx((way["driving_s"] + 4 * 20) / 60)
    assert list(read_measurements(out).poses) == way["order"]
    text = program.read_text(encoding="ascii")
    assert text.count("PTP") >= 4 + way["via_points"]
    stops = text.replace("\n; ", " ").partition("Poses: ")[2]
    assert stops.index("p1 ") < stops.index("p2 ") < stops.index("p3 ") < stops.index("p4 ")
    assert text.count("\nHALT\n") == 4  # nobody hangs on loads while the arm goes on
    wrong = run("plan", "--model", MODEL, "--count", "4", *FEW, "--program", "way.nc")
    assert wrong.code == 2 and "joint values" in wrong.stderr


def test_poses_are_given_as_places_of_the_point(run, tmp_path: Path) -> None:
    """One pose at each, feasible and as asked; what cannot be reached is named, and why."""
    places, out, page = (tmp_path / name for name in ("places.csv", "plan.csv", "plan.html"))
    places.write_text(
        "point,x[mm],y[mm],z[mm]\nA,1200,0,300\nB,1300,400,500\nfar,5000,0,0\nlow,1100,300,-700\n"
    )
    words = ("--model", MODEL, "--places", str(places), "--tool-axis", "0,0,-1")
    words += ("--point=-60,40,150 mm", "--floor=-0.6 m", "--directions", "4", "--loads", "2")
    outcome = run("plan", *words, "--out", str(out), "--page", str(page), "--json")
    assert outcome.code == 0, outcome.stderr
    plan = read_measurements(out)
    assert set(plan.poses) == {"A", "B"} and plan.n_readings == 4
    robot = load_robot("motoman_sk120")
    where = robot.screws(plan.joints, point=plan.point)
    wanted = {"A": (1.2, 0.0, 0.3), "B": (1.3, 0.4, 0.5)}
    np.testing.assert_allclose(where.position, [wanted[p] for p in plan.pose], atol=1e-6)
    np.testing.assert_allclose(where.rotation[:, :, 2], [[0, 0, -1]] * 4, atol=1e-6)
    remarks = " ".join(outcome.document["remarks"])
    assert "far: no pose reaches it" in remarks and "low: of" in remarks and "floor" in remarks
    assert '"label":"pose B"' in page.read_text()
    places.write_text("point,x[mm],y[mm],z[mm]\nfar,5000,0,0\n")
    assert run("plan", *words).code == 1
    assert run("plan", "--model", MODEL, "--count", "3", "--tool-axis", "0,0,1").code == 2
    places.write_text("point,x[mm],y[mm],z[mm]\nA,1200,0,300\nB,1300,400,500\nA,1300,0,500\n")
    twice = run("plan", *words)
    assert twice.code == 2 and "'A'" in twice.stderr and "line 4" in twice.stderr


def test_a_pose_to_which_no_way_leads_gives_way_to_another(run, tmp_path: Path, monkeypatch):
    from sk120stiff.plan import planned as command

    asked: list[np.ndarray] = []
    drive = command.in_order

    def blocked(plan, robot, cell, seed):
        asked.append(plan.joints)
        if len(asked) == 1:
            raise NoWay(robot.name, 0, 1, 1)
        return drive(plan, robot, cell, seed)

    monkeypatch.setattr(command, "in_order", blocked)
    way = tmp_path / "way.script"
    outcome = run("plan", "--model", MODEL, "--count", "3", *FEW, "--program", str(way), "--json")
    assert outcome.code == 0, outcome.stderr
    assert outcome.document["route"]["left_out"] == 1 and [len(a) for a in asked] == [3, 2, 3]
    assert not (asked[-1] == asked[0][1]).all(axis=1).any()


def test_where_other_poses_are_cut_off_too_there_are_fewer(run, tmp_path: Path, monkeypatch):
    from sk120stiff.plan import planned as command

    drive = command.in_order

    def blocked(plan, robot, cell, seed):
        if len(plan.poses) == 6:
            raise NoWay(robot.name, 0, 1, 1)
        return drive(plan, robot, cell, seed)

    monkeypatch.setattr(command, "in_order", blocked)
    made, way = tmp_path / "plan.csv", tmp_path / "way.script"
    words = ("--model", MODEL, "--count", "6", *FEW, "--program", str(way), "--out", str(made))
    outcome = run("plan", *words)
    assert outcome.code == 0, outcome.stderr
    assert "1 pose fewer than was asked for" in outcome.stdout
    assert read_measurements(made).poses == ("p1", "p2", "p3", "p4", "p5")


@pytest.mark.parametrize("said", ["no free way to it was found", "the motors hold no load there"])
def test_a_place_that_falls_out_is_named(run, tmp_path: Path, monkeypatch, said: str) -> None:
    from sk120stiff.plan import planned as command

    drive, drawn = command.in_order, command.feasible_pool

    def blocked(plan, robot, cell, seed):
        if "B" in plan.poses:
            raise NoWay(robot.name, 0, *2 * [plan.poses.index("B")])
        return drive(plan, robot, cell, seed)

    def unheld(robot, **options):
        pool = drawn(robot, **options)
        beside = robot.screws(pool.load_cases.a, point=options["point"]).position[:, 1] > 0.3
        return Pool(pool.load_cases.rows(~beside), pool.remarks)

    if "way" in said:
        monkeypatch.setattr(command, "in_order", blocked)
    else:
        monkeypatch.setattr(command, "feasible_pool", unheld)
    places, way = tmp_path / "places.csv", tmp_path / "way.script"
    rows = [f"{name},1300,{y},500,180,0,0" for name, y in (("A", 0), ("B", 400), ("C", -300))]
    header = "point,x[mm],y[mm],z[mm],roll[deg],pitch[deg],yaw[deg]"
    places.write_text("\n".join([header, *rows]) + "\n")
    words = ("--model", MODEL, "--places", str(places), "--directions")
    outcome = run("plan", *words, "2", "--point=-60,40,150 mm", "--program", str(way), "--json")
    assert outcome.code == 0, outcome.stderr
    assert {row["pose"] for row in outcome.document["poses"]} == {"A", "C"}
    assert f"B: {said}." in outcome.document["remarks"]


@pytest.fixture
def posted(tmp_path: Path) -> Path:
    """A planar arm, with a post before it where it is stretched."""
    arm = tmp_path / "arm.urdf"
    arm.write_text(re.sub(r'effort="\d+"', 'effort="1000"', ARM), encoding="utf-8")
    (tmp_path / "cell.yaml").write_text(
        "pedestal: none\nobstacles:\n- {name: post, sphere: 0.1, xyz: [1.4, 0, 0], unit: m}\n",
        encoding="utf-8",
    )
    return arm


def test_a_robot_may_stand_first_and_jumps_between_rows_are_told(run, posted: Path) -> None:
    """Rows that are free each, with a post between two of them: told, and no refusal."""
    made = run("plan", str(posted), "--count", "3", *FEW, "--json")
    assert made.code == 0, made.stderr
    assert len(made.document["poses"]) == 3
    rows = posted.with_name("rows.csv")
    way = ["30,0,0,0,0", "20,0,0,0,0", "-30,0,0,0,0", "-31,0,0,0,0"]
    rows.write_text("\n".join(["a[deg],b[deg],fx[N],fy[N],fz[N]", *way]) + "\n", encoding="utf-8")
    found = run("plan", str(posted), "--check", str(rows), "--json")
    assert found.code == 0 and found.document["feasible"] == 4, found.document
    (jump,) = found.document["jumps"]
    assert jump["lines"] == [3, 4] and jump["meets"] == "fore touches post"
    said = run("plan", str(posted), "--check", str(rows)).stdout
    assert "fore touches post" in said and "put points between" in said


def test_rows_are_followed_in_the_order_in_which_they_were_read(run, posted: Path) -> None:
    file = posted.with_name("plan.csv")
    rows = ["p1,30,0,0,0,9,1", "p2,-30,0,0,0,9,3", "p3,28,0,0,0,9,2"]
    head = "pose,a[deg],b[deg],fx[N],fy[N],fz[N],order"
    file.write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    file.with_suffix(".yaml").write_text(
        "robot: arm.urdf\nforce: {frame: base}\ndisplacement: {zero: separate}\n", encoding="utf-8"
    )
    found = run("plan", "--check", str(file), "--json").document
    assert [jump["poses"] for jump in found["jumps"]] == [["p3", "p2"]]


def test_what_no_plan_shows_has_no_promise_and_spoils_no_other(run, tmp_path: Path) -> None:
    """A drift goes by the order of the readings: its prior is no standard error."""
    held = tmp_path / "model.yaml"
    model = base_model(load_robot("motoman_sk120"))
    write_model(model + effect(model.robot, "reading_drift", "tracker"), held)
    plain = run("plan", MODEL, "--count", "4", *FEW, "--json").document
    outcome = run("plan", str(held), "--count", "4", *FEW, "--json")
    assert outcome.code == 0, outcome.stderr
    found = outcome.document
    *springs, drift, _, last = found["expected"]
    assert [p["std"] for p in springs] == pytest.approx([p["std"] for p in plain["expected"]])
    assert found["gain"] == pytest.approx(plain["gain"])
    assert drift["name"] == "reading_drift:tracker.rate_x"
    for p in (drift, last):
        assert p["std"] is p["internal_std"] is None
        assert "a column order or time[s]" in p["reason"]
    for asked in (("--for", "reading_drift"), ("--between", "reading_drift,force_bias")):
        refused = run("plan", str(held), "--count", "4", *FEW, *asked, "--json")
        assert refused.code == 2
        assert refused.error["where"] == asked[0]
        assert "order or time[s]" in refused.error["message"]


@pytest.mark.parametrize("command", ["plan", "posture", "map", "view"])
def test_a_page_that_no_browser_would_open_is_refused(run, command: str, tmp_path: Path) -> None:
    """A page named like a picture is one that opens in no program."""
    page, path = str(tmp_path / "page.pdf"), tmp_path / "path.csv"
    path.write_text("x[mm],y[mm],z[mm],fx[N],fy[N],fz[N]\n1500,0,300,0,0,-300\n")
    options = {
        "plan": ("--count", "3", *FEW, "--page", page),
        "posture": (str(path), "--out", str(tmp_path / "b.csv"), "--page", page),
        "map": ("--grid", "joint_1_s=0 deg", "--out", str(tmp_path / "m.zarr"), "--page", page),
        "view": ("--static", page),
    }[command]
    refused = run(command, MODEL, *options, "--json")
    assert refused.code == 2 and "page.html" in refused.error["remedy"]
    assert list(tmp_path.iterdir()) == [path]


def test_small_loads_are_shown_with_their_tenths(run) -> None:
    said = run("plan", MODEL, "--count", "3", "--force", "5 N", *FEW).stdout
    rows = re.findall(r"^ p\d .*$", said, re.MULTILINE)
    assert len(rows) == 3
    for row in rows:
        force = [float(word) for word in row.split()[-3:]]
        assert np.linalg.norm(force) == pytest.approx(5.0, abs=0.1)
