"""Several files of one campaign, between which the tracker moved, its marker was mounted anew, or
neither.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.spatial.transform import Rotation

from sk120stiff import load_robot
from sk120stiff.errors import InputError, Refusal
from sk120stiff.measurements.importers import Imported, Told, import_readings
from tests.measurements.importers.tracked import MARKER, SHIFT, TURN, Campaign, campaign, ur5

ELSEWHERE, AWAY = Rotation.from_rotvec([-0.3, 0.8, -1.7]), np.array([-2500.0, 1000.0, 900.0])
HEAD = "Point;" + ";".join(f"J{k} [deg]" for k in range(1, 7)) + ";X [mm];Y [mm];Z [mm]"


def moved(seen: Campaign) -> Campaign:
    """The same from another place."""
    base = TURN.inv().apply(seen.x - 1e3 * SHIFT)
    return replace(seen, x=ELSEWHERE.apply(base) + AWAY)


def remounted(seen: Campaign, shift: np.ndarray) -> Campaign:
    """The same with the marker elsewhere on the tool [mm]."""
    zeros = np.radians([0.0, 0.08, -0.05, 0.1, 0.05, 0.0])  # as `campaign` has them
    R = load_robot(ur5(), tool="tool0").placement(np.radians(seen.q) + zeros)[:, :3, :3]
    return replace(seen, x=seen.x + TURN.apply(R @ shift))


def part(seen: Campaign, rows: slice) -> Campaign:
    return Campaign(seen.names[rows], seen.q[rows], seen.x[rows])


def written(folder: Path, name: str, seen: Campaign, head: str = HEAD, more: str = "") -> Path:
    path = folder / name
    rows = zip(seen.names, seen.q, seen.x, strict=True)
    lines = [";".join([n, *(f"{v:.5f}" for v in (*q, *x))]) + more for n, q, x in rows]
    path.write_text("\n".join([head, *lines]) + "\n")
    return path


def brought(paths: list[Path], **more: object) -> Imported:
    return import_readings(paths, load_robot(ur5(), tool="tool0"), Told(), **more)


def labels(found: Imported, header: str) -> tuple[str, ...] | None:
    return dict(found.columns).get(header)


WHOLE = campaign(60)


def test_the_tracker_moved_from_file_to_file(tmp_path: Path) -> None:
    first, second = part(WHOLE, slice(0, 36)), moved(part(WHOLE, slice(36, 60)))
    paths = [written(tmp_path, "monday.csv", first), written(tmp_path, "friday.csv", second)]
    found = brought(paths)
    assert labels(found, "station") == ("monday",) * 36 + ("friday",) * 24
    assert labels(found, "series") is None
    assert found.fitted is not None and found.fitted.rms < 3e-3
    assert np.allclose(found.fitted.marker, MARKER, atol=3e-3)
    angles = (Rotation.from_matrix(found.fitted.turns[1]) * ELSEWHERE.inv()).magnitude()
    assert angles < 5e-3
    assert found.draft.sheet.lines[36] == 39  # 37 lines of the first file, and a header
    assert any("friday.csv at 38" in said for said in found.said)
    assert any("frame of its own for each of monday and friday" in said for said in found.said)


def test_registered_they_are_in_one_frame(tmp_path: Path) -> None:
    first, second = part(WHOLE, slice(0, 36)), moved(part(WHOLE, slice(36, 60)))
    paths = [written(tmp_path, "monday.csv", first), written(tmp_path, "friday.csv", second)]
    found = brought(paths, into_base=True)
    found.write(tmp_path / "own.csv")
    x = np.array([[float(c) for c in dict(found.columns)[f"{a}[mm]"]] for a in "xyz"]).T
    assert np.abs(x - TURN.inv().apply(WHOLE.x - 1e3 * SHIFT)).max() < 10.0
    record = yaml.safe_load((tmp_path / "own.yaml").read_text())["registered"]
    assert [entry["station"] for entry in record] == ["monday", "friday"]
    assert np.allclose(record[1]["xyz"], AWAY, atol=10.0)
    assert found.readings.absolute is not None and found.readings.absolute.frame == "base"


def test_few_positions_a_file_in_one_frame_stay_in_one(tmp_path: Path) -> None:
    parts = [part(WHOLE, slice(k, k + 4)) for k in range(0, 60, 4)]
    found = brought([written(tmp_path, f"pose{k}.csv", p) for k, p in enumerate(parts)])
    assert labels(found, "station") is None and labels(found, "series") is None
    assert any("one frame of the tracker fits all 15" in item for item in found.draft.unused)
    assert found.readings.n_readings == 60


@pytest.mark.parametrize("elsewhere", [True, False])
def test_a_marker_that_was_mounted_anew(elsewhere: bool, tmp_path: Path) -> None:
    shift = np.array([20.0, -35.0, -10.0])
    second = remounted(part(WHOLE, slice(30, 60)), shift)
    second = moved(second) if elsewhere else second
    paths = [written(tmp_path, "a.csv", part(WHOLE, slice(0, 30)))]
    found = brought([*paths, written(tmp_path, "b.csv", second)])
    assert labels(found, "series") == ("a",) * 30 + ("b",) * 30
    assert found.fitted is not None and found.fitted.rms < 3e-3
    assert np.allclose(1e3 * found.fitted.apart[1], shift, atol=3.0)
    assert any("mounted anew" in said for said in found.said)


def test_too_few_positions_from_a_place_are_set_aside_or_refused(tmp_path: Path) -> None:
    own = written(tmp_path, "a.csv", part(WHOLE, slice(0, 10)))
    few = written(tmp_path, "b.csv", moved(part(WHOLE, slice(40, 42))))
    many = written(tmp_path, "c.csv", part(WHOLE, slice(10, 40)))
    found = brought([own, many, few])
    assert np.flatnonzero(found.wild).tolist() == [40, 41]
    paths = [own, few]
    for k in range(42, 50, 2):
        shifted = moved(part(WHOLE, slice(k, k + 2)))
        shifted = replace(shifted, x=shifted.x + 300.0 * k)
        paths.append(written(tmp_path, f"d{k}.csv", shifted))
    with pytest.raises(Refusal) as refused:
        brought(paths)
    assert "and fewer were read from b, d42, d44, d46 and d48" in refused.value.remedy


def test_a_column_of_stations_in_one_file(tmp_path: Path) -> None:
    """Told where it is needed; where all stations are in one frame and few, it is not taken."""
    path = tmp_path / "all.csv"
    own = [part(WHOLE, slice(0, 30)), moved(part(WHOLE, slice(30, 60)))]
    text = [written(tmp_path, "x.csv", p, more=f";S{k}").read_text() for k, p in enumerate(own)]
    rows = text[0].splitlines()[1:] + text[1].splitlines()[1:]
    path.write_text("\n".join([HEAD + ";Station", *rows]) + "\n")
    assert labels(brought([path]), "station") == ("S0",) * 30 + ("S1",) * 30
    rows = [f"{row.rpartition(';')[0]};{k % 20}" for k, row in enumerate(rows)]
    bundled = written(tmp_path, "x.csv", WHOLE).read_text().splitlines()[1:]
    path.write_text(
        "\n".join([HEAD + ";Station", *(f"{row};{k % 20}" for k, row in enumerate(bundled))]) + "\n"
    )
    found = brought([path])
    assert labels(found, "station") is None and found.readings.n_readings == 60


def test_labels_of_one_name_are_told_apart(tmp_path: Path) -> None:
    again = replace(part(WHOLE, slice(30, 60)), names=WHOLE.names[:30])
    paths = [
        written(tmp_path, "a.csv", part(WHOLE, slice(0, 30))), written(tmp_path, "b.csv", again)
    ]  # fmt: skip
    found = brought(paths)
    assert labels(found, "pose")[29:31] == ("a/P30", "b/P1")
    assert len(found.readings.poses) == 60


def test_an_order_that_begins_anew_is_left_out(tmp_path: Path) -> None:
    paths = []
    for name, rows in (("a.csv", slice(0, 30)), ("b.csv", slice(30, 60))):
        text = written(tmp_path, name, part(WHOLE, rows)).read_text().splitlines()
        text = [f"{text[0]};order", *(f"{row};{k}" for k, row in enumerate(text[1:], start=1))]
        paths.append(tmp_path / name)
        paths[-1].write_text("\n".join(text) + "\n")
    assert labels(brought(paths), "order") is None
    second = paths[1].read_text().splitlines()
    later = [f"{row.rpartition(';')[0]};{30 + k}" for k, row in enumerate(second[1:], start=1)]
    paths[1].write_text("\n".join([second[0], *later]) + "\n")
    order = labels(brought(paths), "order")
    assert order is not None and order[29:31] == ("30", "31")


def test_files_that_do_not_go_together_are_refused(tmp_path: Path) -> None:
    good = written(tmp_path, "a.csv", part(WHOLE, slice(0, 30)))
    inches = written(tmp_path, "b.csv", part(WHOLE, slice(30, 60)), HEAD.replace("[mm]", "[m]"))
    with pytest.raises(InputError, match="in m, in the first file in mm"):
        brought([good, inches])
    fewer = tmp_path / "c.csv"
    lines = [line.rpartition(";")[0] for line in good.read_text().splitlines()]
    fewer.write_text("\n".join(lines) + "\n")
    with pytest.raises((InputError, Refusal)):
        brought([good, fewer])
    with pytest.raises(InputError, match="given twice"):
        brought([good, good])
    with pytest.raises(InputError, match=r"neither names nor times.*--before FILE"):
        brought([good, inches], joints_file=good)
    with pytest.raises(InputError, match="no file is given"):
        brought([])
