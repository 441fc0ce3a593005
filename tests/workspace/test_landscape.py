"""The posture that was chosen is the optimum of the landscape that is drawn around it."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.errors import InputError
from sk120stiff.show.figures import posture_choice
from sk120stiff.workspace import PathTask, best_posture, posture_landscape
from tests.workspace.test_posture import DOWN, compliances, soft_wrist

LOAD = np.array([0.0, 200.0, 500.0, 0.0, 0.0, 0.0])
LINE = np.linspace([1.5, -0.1, 0.3], [1.5, 0.1, 0.3], 3)


@pytest.mark.parametrize("axis", [DOWN, None])
@pytest.mark.parametrize("minimise", ["deflection", "compliance"])
def test_no_posture_of_the_landscape_is_better(axis: np.ndarray | None, minimise: str) -> None:
    arm, path = soft_wrist(), PathTask(LINE, axis=axis, wrench=LOAD)
    found = best_posture(arm, path, minimise=minimise)
    landscape = posture_landscape(found, angles=40, starts=8)
    assert landscape.tilt == (axis is None)
    assert landscape.objective.min() == pytest.approx(found.objective, rel=1e-6)
    at = np.argmin(landscape.objective)
    assert landscape.angle[at] == pytest.approx(landscape.chosen[0], abs=1e-6)
    assert landscape.objective.max() > 1.1 * found.objective  # there was something to choose


def test_the_landscape_says_what_the_formulas_say() -> None:
    """One point, tool down: the deflection by compliance matrices made elsewhere."""
    arm, path = soft_wrist(), PathTask(LINE[:1], axis=DOWN, wrench=LOAD)
    found = best_posture(arm, path, minimise="deflection")
    landscape = posture_landscape(found, angles=12)
    C = compliances(arm, found.a, LOAD)
    deflection = np.linalg.norm((C[0] @ LOAD)[:3])
    assert landscape.chosen[1] == pytest.approx(deflection, rel=1e-6)
    x = arm.kinematics(found.a).rotation[0, :, 0]  # the tool points down: its turn is clockwise
    assert landscape.chosen[0] == pytest.approx(np.arctan2(-x[1], x[0]), abs=1e-9)


def test_the_picture_marks_the_chosen_one_and_names_units() -> None:
    arm, path = soft_wrist(), PathTask(LINE, axis=DOWN, wrench=LOAD)
    found = best_posture(arm, path)
    landscape = posture_landscape(found, angles=40, starts=8)
    figure = posture_choice(
        found.per_point,
        compliance=True,
        landscape=(landscape.angle, landscape.objective),
        chosen=landscape.chosen,
        blind=found.admissible,
    )
    left, right = figure.axes
    cloud, mark = left.lines
    assert mark.get_ydata()[0] == pytest.approx(1e-6 / found.objective)
    assert max(cloud.get_ydata()) == pytest.approx(mark.get_ydata()[0], rel=1e-6)
    assert "[deg]" in left.get_xlabel()
    assert "[N/µm]" in left.get_ylabel()
    assert "[N/µm]" in right.get_ylabel()
    assert min(right.lines[0].get_ydata()) == pytest.approx(1e-6 / found.objective)


def test_a_fixed_orientation_has_no_landscape() -> None:
    arm = soft_wrist()
    path = PathTask(LINE, axis=DOWN, wrench=LOAD)
    fixed = replace(path, axis=None, rotation=np.diag([1.0, -1.0, -1.0]))
    found = best_posture(arm, fixed, rounds=1)
    with pytest.raises(InputError, match="fixes the orientation"):
        posture_landscape(found)
    figure = posture_choice(found.per_point, compliance=True)
    assert len(figure.axes) == 1
