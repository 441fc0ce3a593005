"""Laws out of proportion against arithmetic that fits on the back of an envelope."""

from __future__ import annotations

import numpy as np
import pytest

from sk120stiff.effects import CATALOGUE, load_case
from sk120stiff.effects.options import Options
from sk120stiff.errors import InputError
from sk120stiff.model import Model
from tests.effects.test_laws import NOTHING, boom, close


def bent(robot, name, load, **values):
    """Displacement [m] by a part out of proportion; its law is the one that the names tell."""
    kind = CATALOGUE[name]
    (where,) = kind.places(robot)[:1]
    law = kind.at(robot, where, Options(shape=tuple(values)))
    model = Model(robot) + law
    model = model.with_public(**{f"{law.id}.{key}": value for key, value in values.items()})
    wrench = np.zeros(6)
    wrench[: len(load)] = load
    return model.predict(load_case(robot, NOTHING, wrench))[0]


def test_a_foundation_gives_way_more_and_more():
    # rigid without load, 1e6 N·m/rad from 600 N·m on: 300 N·m turn it by 300²/(2·600)/1e6
    names = [f"stiffness_{axis}_at_{load}" for load in (0, 600) for axis in "xy"]
    more = dict.fromkeys(names, np.inf) | {"stiffness_y_at_600": 1e6}
    close(bent(boom(), "base_rocking", [0, 0, 100], **more), [0, 0, 75e-6 * 3])
    # 900 N·m: 600/2 for the first 600, and 300 straight on
    close(bent(boom(), "base_rocking", [0, 0, 300], **more), [0, 0, 600e-6 * 3])
    # the boom's own 20 kg at one metre were there before: -196.2 N·m
    heavy, pressed = boom(mass=20.0), 20 * 9.81
    turned = ((300 - pressed) ** 2 + pressed**2) / 1200 * 1e-6  # from -196.2 to 103.8 N·m
    close(bent(heavy, "base_rocking", [0, 0, 100], **more), [0, 0, 3 * turned])
    # rubber: soft without load, and rigid from there on
    less = dict.fromkeys(names, np.inf) | {"stiffness_y_at_0": 1e6}
    close(bent(boom(), "base_rocking", [0, 0, 100], **less), [0, 0, (300 - 75) * 3e-6])


def test_a_tool_gives_way_to_one_side():
    axes = [f"{way}_{axis}" for way in ("turn", "shift") for axis in "xyz"]
    ends = [f"stiffness_{axis}_{side}" for side in ("positive", "negative") for axis in axes]
    values = dict.fromkeys(ends, np.inf) | {"stiffness_shift_z_positive": 1e7}
    close(bent(boom(), "tool_compliance", [0, 0, 100], **values), [0, 0, 1e-5])
    close(bent(boom(), "tool_compliance", [0, 0, -100], **values), [0, 0, 0])


def test_a_stiffness_is_written_as_people_would() -> None:
    spec = CATALOGUE["joint_tilt"].sample().parameters[0]
    assert 1.0 / (1.0 / 5e4) != 5e4
    assert spec.public(1.0 / 5e4) == 5e4
    assert spec.internal(spec.public(1.0 / 3e5 / 7.0)) == 1.0 / 3e5 / 7.0  # and nothing is lost


@pytest.mark.parametrize("end", ["_at_-3", "_at_soon", "_at_1e400"])
def test_a_law_out_of_proportion_needs_its_load(end):
    with pytest.raises(InputError) as refused:
        bent(boom(), "base_rocking", [0, 0, 1], **{"stiffness_x_at_0": 1e7, f"stiffness_x{end}": 1})
    assert "stiffness_x_at_150 for 150 N*m" in str(refused.value)


def test_a_model_file_holds_one_law():
    both = {"stiffness_x_positive": 1e7, "stiffness_y_at_0": 1e7}
    with pytest.raises(InputError, match="belong to two laws"):
        bent(boom(), "base_rocking", [0, 0, 1], **both)
