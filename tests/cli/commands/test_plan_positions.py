"""`sk120stiff plan --positions`: where to read a marker, and what to hang on the tool."""

from dataclasses import replace
from pathlib import Path

import pytest

import sk120stiff as sk
from sk120stiff.cli.commands.plan.asked import hung_on
from sk120stiff.errors import InputError
from sk120stiff.identify.written import with_values
from sk120stiff.model import read_model

MODEL = "robots/motoman_sk120/model.yaml"
FEW = ("--candidates", "60")


def test_positions_are_planned_simulated_and_fitted(run, tmp_path: Path) -> None:
    plan, made = str(tmp_path / "plan.csv"), str(tmp_path / "made.csv")
    asked = (
        "--positions",
        "--count",
        "30",
        "--payload",
        "0,80 kg",
        "--payload-point",
        "0,0,100 mm",
    )
    outcome = run(
        "plan", MODEL, *asked, "--candidates", "80", "--point", "60,0,150 mm", "--noise", "20 um",
        "--out", plan, "--json",
    )  # fmt: skip
    assert outcome.code == 0, outcome.stderr
    found = outcome.document
    assert {row["payload_kg"] for row in found["poses"]} <= {0.0, 80.0}
    assert found["remarks"][-1] == "Payloads are 0 kg and 80 kg (--payload)."
    assert "from pose to pose were not checked for collisions" in found["remarks"][-2]
    assert f"--check {plan}" in found["remarks"][-2] and "--program FILE" in found["remarks"][-2]
    assert len(found["poses"]) == 60 and found["sigma_um"] == pytest.approx(20.0)
    assert "sigma: 20" in Path(plan).with_suffix(".yaml").read_text()
    assert 1.0 < found["foretold_um"] < 40.0 and found["gain"] > 1.0
    assert run("plan", "--check", plan).code == 0
    drawn = run("simulate", MODEL, plan, "--noise", "20 um", "--out", made)
    assert "axes are those of the base" in drawn.stdout
    answer = run("identify", made, "--json").document
    identified = {each["name"]: each for each in answer["parameters"]}
    told = [e for e in found["expected"] if "joint_springs" in e["name"] and e["reason"] is None]
    assert told
    model = read_model(MODEL)
    whole = sk.fit(model, sk.read(made))
    rigid = with_values(replace(whole, parts=None)).model
    for expected in told:
        name = expected["name"]
        # What the unstated weight of the arm would move the value by counts in it as well.
        alone = expected["std_if_rigid"]
        assert 0.95 * alone < rigid.parameter(name).std < 1.2 * alone, name
        said = identified[name]["std"]
        assert 0.5 * expected["std"] < said < 2.0 * expected["std"], name  # of one draw
        assert said == pytest.approx(whole.model.parameter(name).std, rel=1e-6)
        assert said > rigid.parameter(name).std
        mostly = rigid.parameter(name).std ** 2 < 0.5 * said**2  # of one draw, too
        bracket = f"{name.removesuffix('.stiffness')} ("
        assert any(bracket in note for note in answer["notes"]) == mostly
    mostly = {each["name"]: each["mostly"] for each in told}
    assert mostly["joint_springs:joint_3_u.stiffness"] == "link_bending:link_3_u"
    more = run(
        "plan", MODEL, "--data", made, "--count", "3", "--candidates", "60", "--json"
    ).document
    assert {row["pose"] for row in more["poses"]} == {"next_1", "next_2", "next_3"}


def test_a_spring_whose_error_is_larger_than_itself_is_said_to_be_hardly_told(run) -> None:
    asked = ("--count", "8", "--payload", "0; 0.5 kg", "--candidates", "40", "--noise", "20 um")
    told = run("plan", MODEL, "--positions", *asked)
    assert told.code == 0
    assert "joint_3_u.stiffness will hardly be told: its error is larger than itself" in told.stdout


def test_payloads_stand_by_positions(run) -> None:
    wrong = run("plan", MODEL, "--count", "4", "--payload", "5 kg")
    assert wrong.code == 2 and "Add --positions" in wrong.stderr
    for text in ("heavy", "-3 kg", "nan", "5", "5 kg or so", "nan kg"):
        none = run("plan", MODEL, "--positions", "--count", "4", f"--payload={text}")
        assert none.code == 2 and "is no mass" in none.stderr


def test_a_plan_of_positions_says_why_it_cannot(run) -> None:
    pulled = run("plan", MODEL, "--positions", "--count", "4", "--force", "100 N")
    assert pulled.code == 2 and "--payload '0; 5 kg'" in pulled.stderr
    loads = run("plan", MODEL, "--positions", "--count", "4", "--loads", "3", "--payload", "9 kg")
    assert loads.code == 2 and "3 payloads at each pose, and 1 is stated" in loads.stderr
    many = run("plan", MODEL, "--positions", "--count", "90", *FEW)
    assert many.code == 2 and "90 poses of 60 to choose from" in many.stderr
    few = run("plan", MODEL, "--positions", "--count", "3", "--payload", "50 kg", *FEW, "--json")
    assert few.document["remarks"][0].startswith("9 numbers cannot tell")
    assert "foretold_um" not in few.document


@pytest.mark.parametrize(
    ("texts", "masses"),
    [
        (["500 g"], [0.5]), (["10 lb"], [4.5359237]), (["0,20 kg"], [0.0, 20.0]),
        (["0,2.5,5 kg"], [0.0, 2.5, 5.0]), (["0; 2.5 kg"], [0.0, 2.5]), (["0 kg, 500 g"], [0, 0.5]),
        (["0, 5 kg", "7 kg"], [0.0, 5.0, 7.0]),
    ],
)  # fmt: skip
def test_payloads_to_choose_from(texts: list[str], masses: list[float]) -> None:
    assert hung_on(texts, None, None, True)["payloads"] == pytest.approx(masses)


@pytest.mark.parametrize("text", ["0,05 kg", "0,5; 5 kg", "0,5, 5 kg", "0,5 kg; 2,5 kg"])
def test_a_comma_that_may_be_a_decimal_one_is_asked_for(text: str) -> None:
    with pytest.raises(InputError, match="may be a decimal one") as refused:
        hung_on([text], None, None, True)
    assert "'0.5 kg'" in str(refused.value.remedy)
