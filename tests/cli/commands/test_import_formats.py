"""From a tracker's export to geometry and springs, two commands by hand, and what goes wrong."""

import errno
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sk120stiff import load_robot, read_measurements
from sk120stiff.measurements.importers import Imported
from sk120stiff.units import to_si
from tests.corpus.robots import example
from tests.measurements.importers.tracked import (
    MARKER,
    SHIFT,
    TURN,
    Campaign,
    campaign,
    joints_file,
    spatial_analyzer,
    ur5,
)

SEEN = campaign()


def exported(folder: Path, seen: Campaign = SEEN, robot: str | None = None) -> tuple[str, ...]:
    """Both files, and the arguments that name them and a place to write to."""
    points, joints = spatial_analyzer(folder, seen), joints_file(folder, seen)
    arm = ("--robot", robot or ur5(), "--tool", "tool0")
    return (str(points), "--joints-file", str(joints), *arm, "--out", str(folder / "own.csv"))


def test_import_then_identify(run, tmp_path: Path) -> None:
    outcome = run("import", *exported(tmp_path), "--json")
    assert outcome.code == 0, outcome.stderr
    found = outcome.document
    assert (found["rows"], found["mode"], found["registered"]) == (40, "positions", False)
    assert found["unused"][:3] == [
        "column Collection",
        "column Group",
        "line 1: SpatialAnalyzer 2023.1",
    ]
    assert 0.2 < found["registration"]["rms_mm"] < 1.0
    data = read_measurements(tmp_path / "own.csv")
    assert data.absolute is not None and data.absolute.frame == "unknown"
    assert data.absolute.fit_point
    # the digits that were printed, in the order of the points, not of the joints' file
    assert data.absolute.channels.position[0] == pytest.approx(1e-3 * SEEN.x[0].round(4), abs=1e-12)
    np.testing.assert_allclose(data.joints, np.radians(SEEN.q.round(5)), atol=1e-12)
    fit = run("identify", str(tmp_path / "own.csv"), "--json").document
    assert fit["placed_rms_um"] == pytest.approx(1e3 * found["registration"]["rms_mm"], rel=0.3)
    assert fit["rms_um"] < 30.0  # the noise is 20 um; zeros are 0.1 degrees off before the fit


def test_registered_positions_are_in_base_axes(run, tmp_path: Path) -> None:
    """Six numbers and their standard errors against the truth of a campaign without noise."""
    robot = load_robot(ur5(), tool="tool0")
    clean = replace(SEEN, x=_seen(robot, SEEN.q))
    found = run("import", *exported(tmp_path, clean), "--register", "--json").document
    fitted = found["registration"]
    assert found["registered"] is True
    assert fitted["rms_mm"] < 2e-4  # four decimals of a millimetre
    assert fitted["marker_m"] == pytest.approx(MARKER, abs=1e-6)
    assert fitted["shift_m"] == pytest.approx(SHIFT, abs=1e-6)
    assert fitted["rotation_rad"] == pytest.approx(TURN.as_rotvec(), abs=1e-6)
    data = read_measurements(tmp_path / "own.csv")
    T = robot.placement(np.radians(SEEN.q))
    at = T[:, :3, 3] + T[:, :3, :3] @ MARKER
    assert data.absolute is not None and data.absolute.frame == "base"
    np.testing.assert_allclose(data.absolute.channels.position, at, atol=1e-6)
    text = (tmp_path / "own.yaml").read_text(encoding="utf-8")
    assert "registered:" in text and "std_rotation:" in text
    assert run("identify", str(tmp_path / "own.csv"), "--json").code == 0


def _seen(robot, q_deg: np.ndarray) -> np.ndarray:
    T = robot.placement(np.radians(q_deg))
    return 1e3 * (TURN.apply(T[:, :3, 3] + T[:, :3, :3] @ MARKER) + SHIFT)


def test_standard_errors_of_the_frame_are_those_of_many_draws(run, tmp_path: Path) -> None:
    robot = load_robot(ur5(), tool="tool0")
    exact, rng = _seen(robot, SEEN.q), np.random.default_rng(2)
    drawn, said = [], []
    for _ in range(12):
        noisy = replace(SEEN, x=exact + rng.normal(0.0, 0.2, exact.shape))
        found = run("import", *exported(tmp_path, noisy), "--preview", "--json").document
        drawn.append(found["registration"]["shift_m"] - SHIFT)
        said.append(found["registration"]["std_shift_m"])
    ratio = np.sqrt(np.mean(np.square(drawn)) / np.mean(np.square(said)))
    assert 0.6 < ratio < 1.5  # 36 numbers, correlated by threes


@pytest.mark.parametrize(
    ("harm", "words"),
    [
        ("metres", "1000 times too small"),
        ("mirrored", "mirrored"),
        ("swapped", "mirrored: one axis has the other sign, or two axes are swapped"),
        ("another robot", "These are not this robot's positions"),
        ("rows", "positions and joints look 1 row apart"),
    ],
)
def test_what_cannot_be_is_refused(run, tmp_path: Path, harm: str, words: str) -> None:
    x = SEEN.x.copy()
    if harm == "metres":
        x = x / 1e3
    elif harm == "mirrored":
        x[:, 1] *= -1.0
    elif harm == "swapped":
        x = x[:, [1, 0, 2]]
    elif harm == "rows":
        x = np.roll(x, 1, axis=0)
    robot = str(example("ur10_robot.urdf")) if harm == "another robot" else None
    refused = run("import", *exported(tmp_path, replace(SEEN, x=x), robot))
    assert refused.code == 1
    assert words in refused.stderr
    assert "Understood: SpatialAnalyzer's ASCII export; Collection as collection" in refused.stderr
    assert not (tmp_path / "own.csv").exists()


def test_a_preview_writes_nothing(run, tmp_path: Path) -> None:
    arguments = exported(tmp_path)
    for option in ("--preview", "--dry-run"):
        shown = run("import", *arguments[:-2], option)
        assert shown.code == 0
        for words in ("SpatialAnalyzer", "the lines above the table", "matched by name",
                      "40 rows at 40 poses", "Not taken over", "Worst rows", "std. error",
                      "position: {frame: unknown}", "Nothing was written"):  # fmt: skip
            assert words in shown.stdout, words
    assert {path.name for path in tmp_path.iterdir()} == {"points.txt", "joints.csv"}
    nowhere = run("import", *arguments[:-2])
    assert nowhere.code == 2 and "--preview" in nowhere.stderr


def test_the_preview_comes_before_the_files(
    run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is told even where writing fails, and leaves stdout to the answer."""

    def full(self: Imported, path: Path) -> None:
        raise OSError(errno.ENOSPC, "No space left on device", str(path))

    arguments = exported(tmp_path)
    with monkeypatch.context() as broken:
        broken.setattr(Imported, "write", full)
        failed = run("import", *arguments)
    assert failed.code == 3 and not failed.stdout
    assert 0 < failed.stderr.index("What can be identified") < failed.stderr.index("No space left")
    outcome = run("import", *arguments, "--json")
    assert outcome.document["rows"] == 40
    assert "What can be identified" in outcome.stderr


def test_wild_rows_are_told_and_written(run, tmp_path: Path) -> None:
    x = SEEN.x.copy()
    x[7] += [5.0, 0.0, 0.0]
    outcome = run("import", *exported(tmp_path, replace(SEEN, x=x)))
    assert outcome.code == 0
    assert "Far off all others, and not counted here: line 11" in outcome.stderr
    assert len(read_measurements(tmp_path / "own.csv").pose) == 40


def test_uncertainties_and_temperature_reach_the_readings(run, tmp_path: Path) -> None:
    rows = ["Point ID;X [mm];Y [mm];Z [mm];U95 X [µm];U95 Y [µm];U95 Z [µm];Temperature [°C]"]
    rows += [f"{n};{';'.join(f'{v:.4f}' for v in x)};30;40;50;20.{k:02d}".replace(".", ",")
             for k, (n, x) in enumerate(zip(SEEN.names, SEEN.x, strict=True))]  # fmt: skip
    (tmp_path / "leica").write_bytes("\n".join(rows).encode("cp1252"))
    arguments = (str(tmp_path / "leica"), *exported(tmp_path)[1:])
    assert run("import", *arguments).code == 0
    data = read_measurements(tmp_path / "own.csv")
    np.testing.assert_allclose(data.sigma[0], to_si([15, 20, 25], "um", "length"))
    assert data.absolute is not None and data.absolute.temperature[1] == pytest.approx(20.01)
    turned = run("import", *arguments, "--register", "--json")
    assert turned.code == 0
    again = read_measurements(tmp_path / "own.csv")
    assert np.sum(again.sigma**2) == pytest.approx(np.sum(data.sigma**2))  # a turn keeps it
    doubled = run("import", *arguments, "--coverage", "1", "--json")
    assert doubled.code == 0
    np.testing.assert_allclose(read_measurements(tmp_path / "own.csv").sigma[0, 0], 30e-6)


def test_markers_of_robodk_keep_their_places(run, tmp_path: Path) -> None:
    """Two markers, each with its place in the row: the fit need not find them."""
    robot = load_robot(ur5(), tool="tool0")
    T = robot.placement(np.radians(SEEN.q))
    places = np.where(np.arange(40)[:, None] % 2, [[0.05, 0.0, 0.1]], [[-0.05, 0.01, 0.12]])
    at = TURN.apply(T[:, :3, 3] + np.einsum("nij,nj->ni", T[:, :3, :3], places)) + SHIFT
    head = [*(f"J{k}" for k in range(1, 7)), *"XYZ", *(f"TCP {a}" for a in "XYZ")]
    rows = [",".join(head)]
    rows += [",".join(f"{v:.6f}" for v in (*q, *(1e3 * x), *(1e3 * p)))
             for q, x, p in zip(SEEN.q, at, places, strict=True)]  # fmt: skip
    source = tmp_path / "robodk.csv"
    source.write_text("\n".join(rows))
    out = tmp_path / "own.csv"
    found = run("import", str(source), *exported(tmp_path)[3:], "--json").document
    assert found["registration"]["rms_mm"] < 1e-5
    data = read_measurements(out)
    assert data.absolute is not None and set(data.absolute.markers) == {"M1", "M2"}
    np.testing.assert_allclose(data.absolute.point, places)
    assert run("identify", str(out), "--json").document["rms_um"] < 0.1


@pytest.mark.parametrize("layout", ["side by side", "in rows"])
def test_three_reflectors_under_a_payload_are_one_campaign(
    run, tmp_path: Path, layout: str
) -> None:
    """Nobody knows where they sit nor where the tracker stands; springs come out of one fit."""
    robot = load_robot(ur5(), tool="tool0")
    places = np.array([[0.06, 0.0, 0.08], [-0.05, 0.07, 0.08], [-0.03, -0.08, 0.14]])
    spring, mass = 5e4, 8.0
    rows = []
    for q in np.radians(SEEN.q[:16]):
        for payload in (0.0, mass):
            bent = q.copy()
            for _ in range(20):
                jacobian = robot.jacobian(bent[None])[0, 2]
                bent = (
                    q + (robot.gravity_torque(bent[None])[0] - 9.81 * payload * jacobian) / spring
                )
            T = robot.placement(bent[None])[0]
            seen = [TURN.apply(T[:3, 3] + T[:3, :3] @ place) + SHIFT for place in places]
            rows.append((np.degrees(q), payload, seen))
    joints = [f"J{k}[deg]" for k in range(1, 7)]
    if layout == "side by side":
        lines = [[*(f"SMR{k} {a}" for k in (1, 2, 3) for a in "XYZ"), *joints, "payload"]]
        lines += [[f"{v:.6f}" for v in (*1e3 * np.concatenate(x), *q, m)] for q, m, x in rows]
    else:
        lines = [["marker", *"xyz", *joints, "payload"]]
        lines += [
            [f"SMR{k}", *(f"{v:.6f}" for v in (*(1e3 * place), *q, m))]
            for q, m, x in rows for k, place in enumerate(x, 1)
        ]  # fmt: skip
    source, out = tmp_path / "three.csv", tmp_path / "own.csv"
    source.write_text("\n".join(",".join(line) for line in lines))
    known = (str(source), *exported(tmp_path)[3:], "--length", "mm", "--load", "kg", "--json")
    found = run("import", *known).document
    assert found["mode"] == "positions" and found["stiffness_identifiable"]
    assert found["rows"] == 6 * 16 and "several markers" in found["identifiable"]
    data = read_measurements(out)
    assert data.absolute is not None and len(set(data.absolute.markers)) == 3
    fitted = run("identify", str(out), "--json").document
    assert fitted["rms_um"] < 0.5
    told = {p["name"]: p["value"] for p in fitted["parameters"]}
    assert told["joint_springs:elbow_joint.stiffness"] == pytest.approx(spring, rel=0.01)
    refused = run("import", *known, "--point", "0,0,0 mm", "--out", str(tmp_path / "no.csv"))
    assert refused.code == 2 and "Leave it out: the fit finds where each sits" in refused.stderr


def test_load_pairs_of_a_tracker_anywhere_give_the_springs(run, tmp_path: Path) -> None:
    """Encoders jitter, the tracker is turned, the marker's place is not known, two loads a pose."""
    robot = load_robot("motoman_sk120")
    springs, rng = np.array([1.4098e6, 4.0076e5, 9.3528e5]), np.random.default_rng(1)
    rows = ["name;X [mm];Y [mm];Z [mm];" + ";".join(f"A{k} [°]" for k in range(1, 7))
            + ";Fx [N];Fy [N];Fz [N];reflector"]  # fmt: skip
    for p, a in enumerate(rng.uniform(-0.6, 0.6, (10, 6))):
        T, J = robot.placement(a), robot.jacobian(a, point=MARKER)[:3, :3]
        for load in ([0.0, 0.0, 0.0], [300.0, 0.0, -490.0], [-300.0, 200.0, -900.0]):
            moved = T[:3, 3] + T[:3, :3] @ MARKER + J @ ((J.T @ load) / springs)
            seen = 1e3 * (TURN.apply(moved) + SHIFT) + rng.normal(0.0, 0.01, 3)
            q = np.degrees(a + rng.normal(0.0, 2e-6, 6))
            numbers = [*(f"{v:.4f}" for v in seen), *(f"{v:.6f}" for v in q), *map(str, load)]
            rows.append(";".join([f"T{p}", *numbers, "SMR 1"]).replace(".", ","))
    source, out = tmp_path / "loaded", tmp_path / "own.csv"
    source.write_bytes("\n".join(rows).encode("cp1252"))
    found = run("import", str(source), "--robot", "motoman_sk120", "--out", str(out), "--json")
    assert found.code == 0, found.stderr
    assert (found.document["mode"], found.document["registered"]) == ("load pairs", True)
    assert (found.document["poses"], found.document["useful_poses"]) == (10, 10)
    data = read_measurements(out)
    assert data.poses[0] == "T0" and data.zero == "shared"
    np.testing.assert_allclose(data.point, MARKER, atol=3e-5)
    values = [p["value"] for p in run("identify", str(out), "--json").document["parameters"]]
    assert values == pytest.approx(springs, rel=0.02)


def test_a_payload_that_nothing_is_paired_with_stays_a_payload(run, tmp_path: Path) -> None:
    mass = [f"{5 * (k % 3)}" for k in range(40)]
    (tmp_path / "loads.csv").write_text("\n".join(["payload [kg]", *mass]))
    arguments = exported(tmp_path)
    found = run("import", *arguments, "--loads-file", str(tmp_path / "loads.csv"), "--json")
    assert found.document["mode"] == "positions"
    data = read_measurements(tmp_path / "own.csv")
    assert data.absolute is not None
    assert data.absolute.payload.tolist() == [float(m) for m in mass]
    assert not data.absolute.payload_placed  # a marker is no centre of mass


def test_files_in_each_other_s_place(run, tmp_path: Path) -> None:
    points, _, joints, *rest = exported(tmp_path)
    refused = run("import", joints, "--joints-file", points, *rest)
    assert refused.code == 2
    assert "Give the file with the points as FILE, and this one as --joints-file" in refused.stderr
    alone = run("import", points, *rest)
    assert alone.code == 2
    assert "no joint values" in alone.stderr and "--joints-file" in alone.stderr


def test_what_was_read_is_not_called_left_out_and_what_is_left_out_has_a_reason(
    run, tmp_path: Path
) -> None:
    points, *rest = exported(tmp_path)
    unused = run("import", points, *rest[:-2], "--preview", "--json").document["unused"]
    assert not [item for item in unused if "Units" in item or "Frame" in item], unused
    rows = ["Leica AT960", "Point ID;X [mm];Y [mm];Z [mm];U95 [mm]"]
    for name, x in zip(SEEN.names, SEEN.x, strict=True):
        rows.append(";".join([name, *(f"{v:.4f}" for v in x), "0.03"]))
    Path(points).write_text("\n".join(rows) + "\n", encoding="utf-8")
    shown = run("import", points, *rest[:-2], "--preview", "--json").document
    (reason,) = [item for item in shown["unused"] if "U95" in item]
    assert "of the whole point" in reason


def test_a_sheet_in_german_with_date_and_time_in_columns_of_their_own(run, tmp_path: Path) -> None:
    path = tmp_path / "messung.csv"
    angles = ";".join(f"A{k} [Grad]" for k in range(1, 7))
    lines = [f"Punktname;{angles};X [mm];Y [mm];Z [mm];Datum;Uhrzeit"]
    for k, (name, q, x) in enumerate(zip(SEEN.names, SEEN.q, SEEN.x, strict=True)):
        numbers = [*(f"{v:.5f}" for v in q), *(f"{v:.4f}" for v in x)]
        cells = [number.replace(".", ",") for number in numbers]
        lines.append(";".join([name, *cells, "14.10.2026", f"{8 + k // 60:02d}:{k % 60:02d}:22"]))
    path.write_text("\n".join(lines), encoding="cp1252")
    out = tmp_path / "own.csv"
    arm = ("--robot", ur5(), "--tool", "tool0")
    outcome = run("import", str(path), *arm, "--out", str(out), "--json")
    assert outcome.code == 0, outcome.stderr
    data = read_measurements(out)
    assert data.time is not None
    np.testing.assert_allclose(data.time - data.time[0], 60.0 * np.arange(len(SEEN.names)))


def test_dates_that_can_be_read_either_way_are_asked_about(run, tmp_path: Path) -> None:
    path, out = tmp_path / "export.csv", tmp_path / "own.csv"
    lines = ["name;" + ";".join(f"J{k} [deg]" for k in range(1, 7)) + ";x[mm];y[mm];z[mm];time"]
    for k, (name, q, x) in enumerate(zip(SEEN.names, SEEN.q, SEEN.x, strict=True)):
        numbers = [*(f"{v:.5f}" for v in q), *(f"{v:.4f}" for v in x)]
        lines.append(";".join([name, *numbers, f"10/{9 + k // 20:02d}/2026 08:{k % 20:02d}:00 AM"]))
    path.write_text("\n".join(lines))
    given = ("import", str(path), "--robot", ur5(), "--tool", "tool0", "--out", str(out))
    asked = run(*given)
    assert asked.code == 2 and not out.exists()
    assert "column time: dates like 10/09/2026 08:00:00 AM" in asked.stderr
    assert "--dates dmy" in asked.stderr and "--dates mdy" in asked.stderr
    assert run(*given, "--dates", "mdy").code == 0
    times = read_measurements(out).time
    assert times is not None and times[-1] == 86400.0 + 19 * 60.0


JOINTS = "J 1,J 2,J 3 + J 2,J 4,J 5,J 6"


@pytest.mark.parametrize(
    "joints",
    [
        JOINTS,
        JOINTS.replace("J ", "J  ").replace(" + ", "+"),
        ",".join(f"J {k} [deg]" + " + J 2 [deg]" * (k == 3) for k in range(1, 7)),
        JOINTS.replace("J 3 + J 2", "0.5*(2*J 3 + 2*J 2)"),
    ],
)
def test_sums_of_columns_whose_names_have_blanks(run, tmp_path: Path, joints: str) -> None:
    """Joint 3 of a controller that counts it from the horizontal: J 3 + J 2."""
    outcome, out = summed(run, tmp_path, joints)
    assert outcome.code == 0, outcome.stderr
    data = read_measurements(out, load_robot(ur5(), tool="tool0").actuated)
    order = [data.joint_names.index(n) for n in load_robot(ur5(), tool="tool0").actuated]
    np.testing.assert_allclose(np.degrees(data.joints[:, order]), SEEN.q, atol=2e-5)
    assert "J_2[deg]" in out.read_text().splitlines()[0]


def test_a_sum_of_a_column_that_is_not_there_lists_those_that_are(run, tmp_path: Path) -> None:
    outcome, out = summed(run, tmp_path, JOINTS.replace("J 2,J 3", "J 2,J 8"))
    assert outcome.code == 2 and not out.exists()
    assert "J 8" in outcome.stderr and "Columns are name, J 1, J 2," in outcome.stderr


def summed(run, folder: Path, joints: str):
    """The outcome of importing with --joints, and the file that was to be written."""
    path, out = folder / "controller.csv", folder / "own.csv"
    lines = [";".join(["name", *(f"J {k} [deg]" for k in range(1, 7)), "x[mm]", "y[mm]", "z[mm]"])]
    for name, q, x in zip(SEEN.names, SEEN.q, SEEN.x, strict=True):
        shown = [q[0], q[1], q[2] - q[1], *q[3:]]
        lines.append(";".join([name, *(f"{v:.5f}" for v in shown), *(f"{v:.4f}" for v in x)]))
    path.write_text("\n".join(lines))
    arm = ("--robot", ur5(), "--tool", "tool0", "--joints", joints)
    return run("import", str(path), *arm, "--out", str(out), "--json"), out
