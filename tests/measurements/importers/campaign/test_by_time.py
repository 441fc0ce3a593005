"""Two logs of one campaign: rows belong together by their times, where names do not tell."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff import load_robot
from sk120stiff.errors import InputError
from sk120stiff.measurements.importers import Imported, Sheet, Told, import_readings
from sk120stiff.measurements.importers.campaign.by_time import ByTime, by_time
from sk120stiff.measurements.importers.campaign.pairing import paired
from tests.measurements.importers.reading import sheet_of
from tests.measurements.importers.tracked import campaign, ur5

RNG = np.random.default_rng(3)
TIMES = 36000.0 + np.cumsum(25.0 + RNG.uniform(-3.0, 5.0, 24))


def of_day(seconds: float) -> str:
    return f"{int(seconds // 3600):02d}:{int(seconds % 3600 // 60):02d}:{seconds % 60:06.3f}"


def points(folder: Path, times: list[str], head: str = "Time") -> Sheet:
    rows = [f"{t};{k};{k};{k}" for k, t in enumerate(times)]
    return sheet_of(folder, "\n".join([f"{head};x [mm];y [mm];z [mm]", *rows]))


def log(folder: Path, times: list[str], head: str = "Time") -> Sheet:
    (folder / "log").mkdir(exist_ok=True)
    rows = [f"{t};{k};0;0;0;0;0" for k, t in enumerate(times)]
    text = "\n".join([head + ";A1;A2;A3;A4;A5;A6", *rows])
    return sheet_of(folder / "log", text, role="joints")


def matched(found: ByTime | str | None) -> dict[int, int]:
    assert isinstance(found, ByTime), found
    return dict(zip(found.rows.tolist(), found.others.tolist(), strict=True))


def test_rows_that_either_file_lacks(tmp_path: Path) -> None:
    """The tracker is read 6.3 s after the controller noted the pose."""
    own = [of_day(t + 6.3) for k, t in enumerate(TIMES) if k not in (4, 15)]
    theirs = [of_day(t) for k, t in enumerate(TIMES) if k not in (9, 20)]
    found = by_time(points(tmp_path, own), log(tmp_path, theirs))
    names = [k for k in range(24) if k not in (4, 15)], [k for k in range(24) if k not in (9, 20)]
    pairs = {names[0][a]: names[1][b] for a, b in matched(found).items()}
    assert pairs == {k: k for k in range(24) if k not in (4, 15, 9, 20)}
    assert isinstance(found, ByTime) and found.shift == pytest.approx(6.3)
    whole = paired(points(tmp_path, own), log(tmp_path, theirs), "joints", by_clock=True)
    assert len(whole.lines) == 20 and len(whole.unpaired) == 4
    assert any("matched by time (Time, Time: 6.3 s later" in note for note in whole.notes)


def test_clocks_that_count_from_times_of_their_own(tmp_path: Path) -> None:
    own = [f"{t - 36010.0:.3f}" for t in TIMES[3:]]
    theirs = [f"{t - 34000.0:.3f}" for t in TIMES]
    found = by_time(points(tmp_path, own, "time [s]"), log(tmp_path, theirs, "time [s]"))
    assert matched(found) == {k: k + 3 for k in range(21)}


def test_hands_are_seconds_late_and_clocks_an_hour_apart(tmp_path: Path) -> None:
    own = [of_day(t + 3600.0 + 1.0 * RNG.random()) for t in TIMES[2:]]
    found = by_time(points(tmp_path, own), log(tmp_path, [of_day(t) for t in TIMES]))
    assert matched(found) == {k: k + 2 for k in range(22)}


def test_even_times_need_clocks_that_show_the_same(tmp_path: Path) -> None:
    own, theirs = 36000.0 + 10.0 * np.arange(2, 20), 36000.0 + 10.0 * np.arange(20)
    told = by_time(points(tmp_path, [of_day(t + 1.0) for t in own]),
                   log(tmp_path, [of_day(t) for t in theirs]))  # fmt: skip
    assert matched(told) == {k: k + 2 for k in range(18)}
    counts = by_time(points(tmp_path, [f"{t:g}" for t in own - 36020.0], "time [s]"),
                     log(tmp_path, [f"{t:g}" for t in theirs - 36000.0], "time [s]"))  # fmt: skip
    assert counts is not None and "nothing else tells" in str(counts)


def test_a_log_of_every_tenth_of_a_second(tmp_path: Path) -> None:
    ticks = np.arange(TIMES[0] - 5.0, TIMES[-1] + 5.0, 0.5)
    found = by_time(points(tmp_path, [of_day(t) for t in TIMES]),
                    log(tmp_path, [of_day(t) for t in ticks]))  # fmt: skip
    off = [ticks[b] - TIMES[a] for a, b in matched(found).items()]
    assert len(off) == 24 and np.abs(off).max() < 0.26


def test_one_file_without_times(tmp_path: Path) -> None:
    assert by_time(points(tmp_path, ["P1", "P2"], "name"), log(tmp_path, ["10:00:00"] * 2)) is None


def test_times_that_are_not_used_are_told(tmp_path: Path) -> None:
    own = [f"{10 * k}" for k in range(8)]
    two = points(tmp_path, own, "time [s]"), log(tmp_path, own, "time [s]")
    found = paired(*two, "joints", by_clock=True)
    assert any("Both files have times, which were not used" in note for note in found.notes)
    with pytest.raises(InputError, match=r"8 points, but 9 rows.*Both files have times"):
        paired(two[0], log(tmp_path, [*own, "80"], "time [s]"), "joints", by_clock=True)


def read(folder: Path, times: bool) -> Imported:
    """Two passes, the second under a payload; the log lacks its fifth row and has one more."""
    seen = campaign(12)
    q, x = np.vstack([seen.q] * 2), np.vstack([seen.x, seen.x + [0.1, 0.2, -0.6]])
    kept = [k for k in range(24) if k != 4]
    clock = [[f"{of_day(t + late)};" if times else "" for t in TIMES] for late in (0.0, 6.3)]
    head = "Time;" if times else ""
    (folder / "log.csv").write_text(
        head + "A1;A2;A3;A4;A5;A6\n"
        + "".join(clock[0][k] + ";".join(f"{v:.5f}" for v in q[k]) + "\n" for k in kept)
    )  # fmt: skip
    rows = [*range(3), *range(4, 24)]
    (folder / "seen.csv").write_text(
        head + "x [mm];y [mm];z [mm];payload [kg]\n"
        + "".join(
            clock[1][k] + ";".join(f"{v:.4f}" for v in x[k]) + f";{5 * (k > 11)}\n" for k in rows
        )
    )  # fmt: skip
    told, robot = Told(angle="deg"), load_robot(ur5(), tool="tool0")
    return import_readings(folder / "seen.csv", robot, told, joints_file=folder / "log.csv")


def test_logs_that_are_shifted_against_one_another(tmp_path: Path) -> None:
    found = read(tmp_path, times=True)
    assert found.readings.n_readings == 22 and found.useful_poses == 10
    assert found.fitted is not None and found.fitted.rms < 3e-3
    lost = [(each.file.name, each.line) for each in found.draft.sheet.unpaired]
    assert lost == [("seen.csv", 5), ("log.csv", 5)]


def test_of_shifted_logs_without_times_the_shift_is_the_cause(tmp_path: Path) -> None:
    seen = campaign(12)
    q, x = np.vstack([seen.q] * 3), np.vstack([seen.x] * 3)
    log_of, of = [k for k in range(36) if k != 14], [k for k in range(36) if k != 30]
    (tmp_path / "log.csv").write_text(
        "A1;A2;A3;A4;A5;A6\n" + "".join(";".join(f"{v:.5f}" for v in q[k]) + "\n" for k in log_of)
    )
    (tmp_path / "seen.csv").write_text(
        "x [mm];y [mm];z [mm];payload [kg]\n"
        + "".join(";".join(f"{v:.4f}" for v in x[k]) + f";{5 * (k > 25)}\n" for k in of)
    )
    with pytest.raises(InputError) as refused:
        import_readings(
            tmp_path / "seen.csv", load_robot(ur5(), tool="tool0"), Told(angle="deg"),
            joints_file=tmp_path / "log.csv",
        )  # fmt: skip
    assert "the rows of log.csv, which were put beside them by order" in refused.value.what
    assert "one of times" in str(refused.value.remedy)


def two_files(folder: Path, names: bool) -> Imported:
    seen = campaign(12)
    head = ("name;" if names else "") + "x [mm];y [mm];z [mm]\n"
    joints = ["name;A1 [deg];A2 [deg];A3 [deg];A4 [deg];A5 [deg];A6 [deg]"]
    for part, load in (("a", 0.0), ("b", 0.5)):
        rows = [
            (f"{name}_{part};" if names else "") + ";".join(f"{v:.4f}" for v in x - [0, 0, load])
            for name, x in zip(seen.names, seen.x, strict=True)
        ]
        (folder / f"{part}.csv").write_text(head + "\n".join(rows[: 12 if part == "a" else 11]))
        joints += [
            ";".join([f"{name}_{part}", *(f"{v:.5f}" for v in q)])
            for name, q in zip(seen.names, seen.q, strict=True)
        ]
    (folder / "joints.csv").write_text("\n".join(joints))
    return import_readings(
        [folder / "a.csv", folder / "b.csv"], load_robot(ur5(), tool="tool0"),
        Told(payloads={"a.csv": 0.0, "b.csv": 5.0}), joints_file=folder / "joints.csv",
    )  # fmt: skip


def test_several_files_and_one_of_joints_by_name(tmp_path: Path) -> None:
    """Rows that are of the other file lack no point."""
    found = two_files(tmp_path, names=True)
    assert found.readings.n_readings == 23 and found.useful_poses == 11
    assert [each.reason for each in found.draft.sheet.unpaired] == ["P12_b of joints.csv: no point"]


def test_several_files_and_one_of_joints_without_names(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"neither names nor times tell.*--before"):
        two_files(tmp_path, names=False)
