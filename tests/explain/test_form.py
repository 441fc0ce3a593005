"""How far below a base rocks lies between the heights that are tried, and is told with its ±."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest

from sk120stiff import Model, base_model, load_robot
from sk120stiff.effects.foundation import PEDESTALS, BaseRocking
from sk120stiff.explain import Options
from sk120stiff.explain.select.form import told_form
from sk120stiff.model import model_from_text, model_text
from tests.explain.readings import answered, hidden
from tests.hidden.generator.arm import Arm
from tests.hidden.generator.mechanism import Insert
from tests.hidden.generator.sk120 import sk120
from tests.hidden.generator.world import Cause

NAMES = ("base_rocking", "base_sliding", "joint_tilt", "link_bending", "gear_hardening")


@dataclass(frozen=True)
class Pedestal(Cause):
    """The base turns about horizontal axes through a point below its frame."""

    name: ClassVar[str] = "base_rocking"
    exact: ClassVar[bool] = True

    def inserts(self, arm: Arm) -> list[Insert]:
        x, y = self.options.get("beside", (0.0, 0.0))
        at = np.array([x, y, -self.options["below"]])
        return [
            Insert(f"rock:{key}", -1, at, np.eye(3)["xy".index(key)], False, self.sizes[key])
            for key in "xy"
        ]


@pytest.fixture(scope="module")
def springs() -> Model:
    model = base_model(load_robot("motoman_sk120"))
    assert model is not None
    return model


@pytest.mark.parametrize(("below", "stiff"), [(0.56, 2e6), (1.23, 1e5)])
def test_it_is_found_with_its_error(springs: Model, below: float, stiff: float) -> None:
    assert below not in PEDESTALS
    cause = Pedestal("base_link", {"x": 1.0 / stiff, "y": 1.6 / stiff}, {"below": below})
    answer = answered(springs, hidden(cause, poses=15, loads=4), options=Options(only=NAMES))
    (finding,) = answer.findings
    law = finding.effect
    assert isinstance(law, BaseRocking)
    told = told_form(answer.final, law)
    assert told is not None
    assert law.beside is None
    (std,) = told.std
    assert abs(law.below - below) < 3.5 * std + 5e-4  # names tell it to the millimetre
    assert std < 0.05 * below
    assert f"lies {law.below:.3f} ± " in " ".join(answer.notes)
    own = [p for p in answer.final.parameters if p.effect == law]
    for p, true in zip(own, (1.0 / stiff, 1.6 / stiff), strict=False):
        assert abs(p.internal - true) < 3.5 * p.internal_std
    for spring, true in zip(answer.final.parameters, sk120().typical.joint.values(), strict=False):
        assert abs(spring.value - true) < 3.5 * spring.std


@pytest.mark.parametrize("below", [0.0, 0.45])
def test_a_base_that_rocks_beside_its_axis(springs: Model, below: float) -> None:
    """As an arm on a vehicle; without the place other names take the rest."""
    cause = Pedestal("base_link", {"x": 1e-6, "y": 2e-6}, {"below": below, "beside": (0.15, -0.10)})
    answer = answered(springs, hidden(cause, poses=15, loads=4), options=Options(only=NAMES))
    law = answer.findings[0].effect
    assert isinstance(law, BaseRocking) and law.beside is not None
    told = told_form(answer.final, law)
    assert told is not None
    true = np.array([below, 0.15, -0.10])
    assert (np.abs([law.below, *law.beside] - true) < 3.5 * told.std + 5e-4).all()
    assert not answer.remainder.significant
    written = model_from_text(model_text(answer.final.model))
    assert [e.id for e in written.effects] == [e.id for e in answer.final.model.effects]
    assert law in [replace(e, scale=law.scale) for e in written.effects if e.id == law.id]


def test_errors_hold_what_the_height_is_known_to(springs: Model) -> None:
    """Over draws of the noise all values are as far off as they say, with the height fitted."""
    cause = Pedestal("base_link", {"x": 1e-6, "y": 2e-6}, {"below": 0.66})
    drives = [1.0 / stiff for stiff in sk120().typical.joint.values()]
    rocking, own = list[float](), list[float]()
    for seed in range(12):
        readings = hidden(cause, poses=8, loads=3, seed=seed)
        final = answered(springs, readings, options=Options(only=("base_rocking",))).final
        soft = [p for p in final.parameters if p.effect.name == "base_rocking"]
        pairs = zip([*soft[:2], *final.parameters[:3]], [1e-6, 2e-6, *drives], strict=False)
        off = [(p.internal - true) / p.internal_std for p, true in pairs]
        rocking += off[:2]
        own += off[2:]
    for z in (rocking, own):
        assert np.sqrt(np.mean(np.square(z))) == pytest.approx(1.0, abs=0.45)
