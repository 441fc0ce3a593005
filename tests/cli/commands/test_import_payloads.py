"""Positions under payloads, as a laboratory writes them: springs and geometry of an own arm."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from sk120stiff import read_measurements
from tests.positions.arm import NAMES, Arm, Array, G, errors, poses, tracked, urdf

CENTRE = np.array([0.06, -0.03, 0.09])  # m, tool frame, of what hangs on it
MASS, NOISE = 30.0, 2e-5  # kg, m
SPRINGS = ("joint_springs:j2.stiffness", "joint_springs:j3.stiffness", "joint_springs:j5.stiffness")


class Hung(Arm):
    """An arm with its payload at `CENTRE`, away from tool origin and marker."""

    def pose(self, q: Array) -> tuple[Array, Array, Array]:
        x, R, energy = super().pose(q)
        return x, R, energy + self.payload * G * (R @ CENTRE) @ self.up


def protocol(folder: Path, count: int = 40) -> tuple[Path, Hung]:
    """Semicolons and decimal commas; all poses without load, then all with it."""
    true = errors(3)
    a, lines, number = poses(count, 5), [], 0
    noise = np.random.default_rng(7)
    for mass in (0.0, MASS):
        arm = Hung(true.compliance, true.shift, true.turn, payload=mass)
        for q, x in zip(np.degrees(a), 1e3 * tracked(arm.stands(a)[0]), strict=True):
            number += 1
            seen = x + 1e3 * noise.normal(0.0, NOISE, 3)
            cells = [f"{number}", *(f"{v:.6f}" for v in q), f"{mass:g}"]
            lines.append(";".join([*cells, *(f"{v:.4f}" for v in seen)]).replace(".", ","))
    head = ";".join(["Nr.", *(f"J{k} [°]" for k in range(1, 7)), "Last [kg]",
                     *(f"{a} [mm]" for a in "XYZ")])  # fmt: skip
    path = folder / "messung.csv"
    path.write_bytes("\n".join(["Messprotokoll;Halle 3", head, *lines]).encode("cp1252"))
    (folder / "six.urdf").write_text(urdf())
    return path, arm


def stiffnesses(document: dict[str, object]) -> dict[str, tuple[float, float]]:
    found = document["parameters"]
    assert isinstance(found, list)
    return {p["name"]: (p["value"], p["std"]) for p in found if p["name"] in SPRINGS}


def test_they_stay_positions_and_tell_springs_geometry_and_where_it_hangs(run, tmp_path) -> None:
    path, arm = protocol(tmp_path)
    out = str(tmp_path / "own.csv")
    words = ("import", str(path), "--robot", str(tmp_path / "six.urdf"), "--out", out)
    told = run(*words, "--json").document
    assert told["mode"] == "positions" and told["useful_poses"] == 40
    assert "--as displacements" in told["because"] and told["because"] in told["identifiable"]
    assert told["largest_load_N"] == pytest.approx(MASS * G)
    data = read_measurements(out)
    assert data.absolute is not None and not data.absolute.payload_placed
    assert data.absolute.payload.tolist() == [0.0] * 40 + [MASS] * 40
    fitted = run("identify", out, "--json").document
    for name, (value, std) in stiffnesses(fitted).items():
        truth = 1.0 / arm.compliance[NAMES.index(name[14:16])]
        assert abs(value - truth) < 4.0 * std and std < 0.1 * truth
    hung = [p for p in fitted["parameters"] if p["name"].startswith("force_point")]
    for found, place in zip(hung, CENTRE, strict=True):
        assert abs(found["value"] - place) < 4.0 * found["std"] and found["std"] < 0.015
    assert any(p["name"].startswith("joint_frame") for p in fitted["parameters"])
    assert fitted["rms_um"] < 1.5e6 * NOISE


def test_as_differences_the_weight_acts_where_it_hangs(run, tmp_path: Path) -> None:
    path, arm = protocol(tmp_path)
    out = str(tmp_path / "own.csv")
    words = ("import", str(path), "--robot", str(tmp_path / "six.urdf"), "--out", out,
             "--as", "displacements")  # fmt: skip
    told = run(*words, "--payload-point", "60,-30,90 mm", "--json").document
    assert told["mode"] == "load pairs" and "--payload-point says" in told["assumed"][-1]
    data = read_measurements(out)
    np.testing.assert_allclose(data.force_point, CENTRE)
    np.testing.assert_allclose(data.point, arm.marker, atol=2e-3)
    stated = run("identify", out, "--json").document
    for name, (value, _) in stiffnesses(stated).items():
        truth = 1.0 / arm.compliance[NAMES.index(name[14:16])]
        assert value == pytest.approx(truth, rel=0.1)
    told = run(*words, "--json").document
    said = told["assumed"][-1]
    assert "at the origin of the tool frame" in said and "--payload-point" in said
    assert "find it" not in said  # nothing is left in the file that would tell its place
    np.testing.assert_array_equal(read_measurements(out).force_point, 0.0)
    assert run("identify", out, "--json").document["rms_um"] > stated["rms_um"]


@pytest.mark.parametrize("register", [(), ("--register",)])
def test_the_marker_s_place_is_none_of_the_payload_s(run, tmp_path: Path, register) -> None:
    path, arm = protocol(tmp_path, 12)
    out = tmp_path / "own.csv"
    at = ",".join(f"{v:g}" for v in 1e3 * arm.marker)
    words = ("import", str(path), "--robot", str(tmp_path / "six.urdf"), "--out", str(out),
             "--point", f"{at} mm", *register)  # fmt: skip
    assert run(*words).code == 0
    data = read_measurements(out)
    assert data.absolute is not None and not data.absolute.payload_placed
    assert "payload" not in yaml.safe_load(out.with_suffix(".yaml").read_text())
    np.testing.assert_allclose(data.absolute.point, np.tile(arm.marker, (24, 1)))
    assert run(*words, "--payload-point", "60,-30,90 mm").code == 0
    data = read_measurements(out)
    assert data.absolute is not None and data.absolute.payload_placed
    np.testing.assert_allclose(data.absolute.payload_point, CENTRE)
