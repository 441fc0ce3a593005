"""`sk.plan` does all that the command does: it drives, uses readings, keeps to places, and says."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.errors import InputError
from sk120stiff.plan import Cell, Places
from sk120stiff.workspace import places_of

FEW = {"candidates": 40, "directions": 4}


@pytest.fixture(scope="module")
def model() -> sk.Model:
    return sk.base_model(sk.load_robot("motoman_sk120"))


def test_a_plan_is_measurements_and_says_what_it_is_worth(model: sk.Model) -> None:
    made = sk.plan(model, 4, **FEW)
    assert isinstance(made, sk.Measurements) and made.displacement is None
    assert made.gain[0] > 1.0 and made.gain[1] > 1.0 and made.way is None
    assert [item.parameter.name for item in made.expected] == list(model.names)
    assert all(item.reason is None and item.std > 0.0 for item in made.expected)
    assert made.remarks
    wished = ["joint_springs:joint_2_l.stiffness"]
    other = sk.plan(model, 4, parameters=wished, **FEW)
    assert [item.parameter.name for item in other.expected] == wished
    both = tuple(sk.effect(model.robot, name) for name in ("base_rocking", "tool_compliance"))
    told = sk.plan(model, 4, between=both, **FEW)
    before, after = told.chosen.evidence
    assert after > before and told.expected == () and told.gain[0] > 1.0


def test_readings_there_are_give_point_noise_and_floor(model: sk.Model) -> None:
    data = sk.bundled_robots()["motoman_sk120"] / "data"
    known = sk.read(data / "table2_calculated.csv", model.robot.actuated)
    made = sk.plan(model, 3, known=known, **FEW)
    assert made.standard == known.noise.sigma and made.zero == known.zero
    np.testing.assert_array_equal(made.point, known.point)
    assert np.isfinite(made.cell.floor)
    alone = sk.plan(model, 3, point=known.point, sigma=made.standard, **FEW)
    for more, less in zip(made.expected, alone.expected, strict=True):
        assert more.std < less.std


def test_a_plan_is_driven_in_the_order_of_its_rows(model: sk.Model) -> None:
    made = sk.plan(model, 4, loads=2, drive=True, **FEW)
    assert made.way is not None and made.left_out == 0
    assert made.poses == ("p1", "p2", "p3", "p4")
    first = [made.pose.index(label) for label in made.poses]
    np.testing.assert_array_equal(made.joints[first], made.way.a[made.way.pose >= 0])


def test_places_have_a_pose_each_unless_a_number_is_asked_for(
    model: sk.Model, tmp_path: Path
) -> None:
    file = tmp_path / "places.csv"
    file.write_text("point,x[mm],y[mm],z[mm]\nA,1200,0,300\nB,1300,400,500\nfar,9000,0,0\n")
    point = np.array([-0.06, 0.04, 0.15])
    places = places_of(file, model.robot, Cell(), point, None)
    assert isinstance(places, Places) and set(places.names) == {"A", "B"}
    assert "far: no pose reaches it." in places.remarks
    made = sk.plan(model, places=places, point=point, directions=2)
    assert set(made.pose) == {"A", "B"} and set(places.remarks) <= set(made.remarks)
    where = model.robot.screws(made.joints, point=point).position
    aim = {"A": [1.2, 0.0, 0.3], "B": [1.3, 0.4, 0.5]}
    np.testing.assert_allclose(where, [aim[label] for label in made.pose], atol=1e-6)
    assert len(sk.plan(model, 3, places=places, point=point, directions=2).poses) == 3
    with pytest.raises(InputError, match="how many poses"):
        sk.plan(model)
