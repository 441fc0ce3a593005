"""`sk120stiff identify`: the paper's readings, every option, and what it refuses."""

from pathlib import Path

import numpy as np
import pytest
import yaml

DATA = "robots/motoman_sk120/data/table2_measured.csv"
SPRINGS = [f"joint_springs:{joint}.stiffness" for joint in ("joint_1_s", "joint_2_l", "joint_3_u")]
YAML = Path(DATA).with_suffix(".yaml")


@pytest.fixture
def copy(tmp_path: Path):
    """A file of the paper's rows changed line by line, with its YAML."""

    def make(name: str, rows: list[str]) -> str:
        path = tmp_path / f"{name}.csv"
        path.write_text("\n".join(rows) + "\n", encoding="utf-8")
        path.with_suffix(".yaml").write_text(YAML.read_text(encoding="utf-8"), encoding="utf-8")
        return str(path)

    return make


@pytest.fixture
def rows() -> list[str]:
    return Path(DATA).read_text(encoding="utf-8").splitlines()


def test_the_papers_readings(run) -> None:
    outcome = run("identify", DATA, "--json")
    assert outcome.code == 0, outcome.stderr
    found = outcome.document
    assert [p["name"] for p in found["parameters"]] == SPRINGS
    values = [p["value"] for p in found["parameters"]]
    np.testing.assert_allclose(values, [1.357343e6, 3.80730e5, 9.03131e5], rtol=1e-5)
    for parameter in found["parameters"]:
        low, high = parameter["interval_95"]
        assert low < parameter["value"] < high
        assert parameter["unit"] == "N*m/rad"
        assert parameter["identifiable"] and parameter["plausible"]
        assert not parameter["at_bound"]
        assert parameter["std"] > 0.0
    assert found["rms_um"] == pytest.approx(17.2011, abs=1e-3)
    assert found["condition"] < 2.0
    assert found["weak_directions"] == []
    assert found["iterations"] >= 1
    assert found["lack_of_fit"]["against"] == found["sigma_from"] == "scatter"
    assert found["degrees_of_freedom"] == 42


def test_both_methods_agree_to_ten_digits(run, tmp_path: Path) -> None:
    model = yaml.safe_load(Path("robots/motoman_sk120/model.yaml").read_text(encoding="utf-8"))
    found = []
    for start in (1e2, 1e7):  # N·m/rad: 1e5 and 1e10 N·mm/rad
        for effect in model["effects"]:
            effect["parameters"]["stiffness"]["value"] = start
        path = tmp_path / "start.yaml"
        path.write_text(yaml.safe_dump(model), encoding="utf-8")
        for method in ("trf", "lm"):
            outcome = run("identify", DATA, "--model", str(path), "--method", method, "--json")
            found.append([p["value"] for p in outcome.document["parameters"]])
            assert outcome.document["parameters"][0]["start"] == pytest.approx(start)
    for other in found[1:]:
        np.testing.assert_allclose(other, found[0], rtol=1e-10)


def test_the_model_is_written_and_predicts(run, tmp_path: Path) -> None:
    out = tmp_path / "model.yaml"
    found = run("identify", DATA, "--with", "base_rocking", "--out", str(out), "--json").document
    written = yaml.safe_load(out.read_text(encoding="utf-8"))
    assert written["provenance"]["data_hash"].startswith("sha256:")
    rocking = written["effects"][-1]["parameters"]
    assert rocking["stiffness_x"]["value"] == float("inf")
    assert rocking["stiffness_x"]["std"] is None
    assert "bound" in rocking["stiffness_x"]["origin"]
    assert found["parameters"][3]["value"] is None  # infinity has no JSON
    assert found["parameters"][3]["at_bound"]
    assert found["parameters"][3]["interval_95"][1] is None
    predicted = run("predict", str(out), DATA, "--json").document
    assert predicted["rms_um"] == pytest.approx(found["rms_um"], rel=1e-9)


def test_more_is_told_on_request(run) -> None:
    outcome = run(
        "identify",
        DATA,
        "--profile",
        "--held-out",
        "--compare",
        "base_rocking",
        "--compare",
        "reading_rotation+closure_coupling",
        "--json",
    )
    found = outcome.document
    for parameter in found["parameters"]:
        np.testing.assert_allclose(parameter["profile_95"], parameter["interval_95"], rtol=5e-3)
    assert found["held_out"]["folds"] == 3
    assert found["held_out"]["rms_um"] == pytest.approx(24.79, abs=0.05)
    names = [line["name"] for line in found["comparison"]]
    assert set(names) == {"model", "base_rocking", "reading_rotation+closure_coupling"}
    best = found["comparison"][0]
    assert best["loss_um"] == 0.0
    assert min(line["bic"] for line in found["comparison"]) == 0.0
    text = run("identify", DATA, "--held-out", "--compare", "base_rocking").stdout
    assert "At poses left out of the fit: 24.8 ±" in text
    assert "ΔBIC" in text


def test_a_model_file_can_be_compared(run, tmp_path: Path) -> None:
    out = str(tmp_path / "other.yaml")
    run("identify", DATA, "--with", "base_sliding", "--out", out)
    lines = run("identify", DATA, "--compare", out, "--json").document["comparison"]
    assert {line["name"] for line in lines} == {"model", out}


def test_free_and_fixed_parameters(run) -> None:
    fixed = run("identify", DATA, "--fix", SPRINGS[0], "--json").document
    assert [p["name"] for p in fixed["parameters"]] == SPRINGS[1:]
    only = run("identify", DATA, "--free", SPRINGS[2], "--json").document
    assert [p["name"] for p in only["parameters"]] == SPRINGS[2:]
    assert only["rms_um"] > fixed["rms_um"] > 17.3
    outcome = run("identify", DATA, "--fix", "joint_springs:joint_9.stiffness")
    assert (outcome.code, outcome.answered) == (2, False)
    assert "joint_1_s" in outcome.stderr


def test_what_the_paper_cannot_tell(run, tmp_path: Path) -> None:
    """Springs in all six joints: with the wrist straight, two carry no torque."""
    model = tmp_path / "six.yaml"
    effects = [
        {
            "name": "joint_springs",
            "where": joint,
            "parameters": {"stiffness": {"value": 1e6, "unit": "N*m/rad"}},
        }
        for joint in ("joint_1_s", "joint_2_l", "joint_3_u", "joint_4_r", "joint_5_b", "joint_6_t")
    ]
    model.write_text(
        yaml.safe_dump({"robot": "motoman_sk120", "effects": effects}), encoding="utf-8"
    )
    found = run("identify", DATA, "--model", str(model), "--json").document
    fourth = found["parameters"][3]
    assert (fourth["value"], fourth["std"], fourth["identifiable"]) == (None, None, False)
    said = " ".join(found["weak_directions"])
    assert "joint_springs:joint_4_r.stiffness does not show in these readings" in said
    assert "joint_springs:joint_6_t.stiffness does not show" in said
    assert found["parameters"][0]["value"] == pytest.approx(1.357343e6, rel=1e-5)
    text = run("identify", DATA, "--model", str(model)).stdout
    assert "not identifiable" in text


def test_aliases_are_named_in_words(run) -> None:
    said = run("identify", DATA, "--with", "force_scale", "--json").document["weak_directions"]
    assert any(
        "joint springs (joint_1_s) and force scale y (sensor) move together" in s for s in said
    )


def test_robust_counts_what_it_trusts_less(run, copy, rows) -> None:
    cells = rows[11].split(",")
    cells[-1] = str(float(cells[-1]) + 0.5)  # half a millimetre
    spoilt = copy("spoilt", [*rows[:11], ",".join(cells), *rows[12:]])
    clean = run("identify", DATA, "--json").document
    plain = run("identify", spoilt, "--json").document
    robust = run("identify", spoilt, "--robust", "--json").document
    assert robust["down_weighted"][0]["where"] == "line 12 (pose 3)"
    assert robust["down_weighted"][0]["weight"] < 0.2
    away = [
        max(
            abs(p["value"] / c["value"] - 1.0)
            for p, c in zip(found["parameters"], clean["parameters"], strict=True)
        )
        for found in (plain, robust)
    ]
    assert away[1] < 0.4 * away[0]
    assert "2 of 15 readings" in run("identify", spoilt, "--robust").stdout


@pytest.mark.parametrize(
    ("change", "hint"),
    [
        (lambda rows: rows[:2], "line 2: one reading alone"),
        (lambda rows: [",".join(row.split(",")[:10]) for row in rows], "no measured displacements"),
        (lambda rows: [rows[0]] + [_unloaded(row) for row in rows[1:]], "no reading has a load"),
        (
            lambda rows: [rows[0] + ",use"] + [row + ",0" for row in rows[1:]],
            "every row is masked",
        ),
        (lambda rows: rows[:1], "no"),
    ],
)
def test_unusable_readings(run, copy, rows, tmp_path: Path, change, hint: str) -> None:
    out = tmp_path / "model.yaml"
    outcome = run("identify", copy("bad", change(rows)), "--out", str(out), "--json")
    assert (outcome.code, outcome.answered) == (2, False)
    assert hint in outcome.stderr
    assert "bad.csv" in outcome.stderr
    assert not out.exists()


def _unloaded(row: str) -> str:
    cells = row.split(",")
    return ",".join([*cells[:7], "0", "0", "0", *cells[10:]])


def test_more_parameters_than_readings(run, copy, rows, tmp_path: Path) -> None:
    few = copy("few", rows[:3])
    out = tmp_path / "model.yaml"
    options = [x for e in ("base_rocking", "base_sliding") for x in ("--with", e)]
    outcome = run("identify", few, *options, "--out", str(out))
    assert outcome.code == 2
    assert "8 parameters cannot be estimated from 2 readings" in outcome.stderr
    assert "line 3" in outcome.stderr
    assert not out.exists()


def test_nothing_that_shows_is_a_refusal(run, tmp_path: Path) -> None:
    model = tmp_path / "wrist.yaml"
    entry = {"stiffness": {"value": 1e5, "unit": "N*m/rad"}}
    effects = [{"name": "joint_springs", "where": "joint_4_r", "parameters": entry}]
    model.write_text(
        yaml.safe_dump({"robot": "motoman_sk120", "effects": effects}), encoding="utf-8"
    )
    out = tmp_path / "model_out.yaml"
    outcome = run("identify", DATA, "--model", str(model), "--out", str(out), "--json")
    assert (outcome.code, outcome.answered) == (1, False)
    assert "show none of the free parameters" in outcome.stderr
    assert not out.exists()


def test_effects_that_do_not_exist_or_do_not_apply(run) -> None:
    assert "did you mean" in run("identify", DATA, "--with", "base_rockin").stderr
    outcome = run("identify", DATA, "--with", "joint_tilt")
    assert outcome.code == 2
    assert "joint_3_u" in outcome.stderr
    lacking = run("identify", DATA, "--with", "reading_drift")
    assert lacking.code == 2
    assert "lack what the effect" in lacking.stderr


def test_any_subset_of_effects_can_be_fitted(run) -> None:
    """45 numbers against dozens of parameters: an answer, and an honest one."""
    chosen = ["joint_tilt:joint_2_l", "base_rocking", "base_sliding", "tool_compliance"]
    chosen += ["reading_rotation", "force_scale", "force_bias", "link_bending:link_2_l"]
    options = [x for name in chosen for x in ("--with", name)]
    outcome = run("identify", DATA, *options, "--json")
    assert outcome.code == 0, outcome.stderr
    found = outcome.document
    assert len(found["parameters"]) > 20
    unknown = [p for p in found["parameters"] if not p["identifiable"]]
    assert unknown
    assert all(p["value"] is None for p in unknown)
    assert len(found["weak_directions"]) > 5
    for parameter in found["parameters"]:
        if parameter["unit"].startswith("N") and parameter["value"] is not None:
            assert parameter["value"] > 0.0 or "force_bias" in parameter["name"]


def test_rows_that_were_pasted_twice_count_once(run, copy, rows) -> None:
    plain, twice = run("identify", DATA, "--json"), copy("twice", [*rows, *rows[1:]])
    outcome = run("identify", twice, "--json")
    assert "15 rows repeat earlier ones" in outcome.stderr
    for key in ("sigma_um", "rms_um", "sigma_stated"):
        assert outcome.document[key] == plain.document[key]
