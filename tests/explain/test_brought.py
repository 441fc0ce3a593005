"""What a user stands an arm on, or puts on its flange, may be far softer than any drive."""

import pytest

from sk120stiff import base_model, load_robot
from sk120stiff.explain import Options
from tests.explain.readings import answered, hidden
from tests.hidden.generator.causes_elastic import BaseRocking, ToolCompliance
from tests.hidden.generator.sk120 import sk120
from tests.hidden.generator.world import Cause

OTHERS = ("joint_tilt", "link_bending", "link_torsion", "closure_coupling", "base_sliding")
WHEELS = BaseRocking("base_link", {"x": 1 / 3e4, "y": 1 / 2e4})
RUBBER = ToolCompliance("tool0", {"rx": 1 / 800.0, "ry": 1 / 500.0})


@pytest.mark.parametrize(
    ("cause", "name"),
    [(WHEELS, "base_rocking:base_link"), (RUBBER, "tool_compliance:tool0")],
)
def test_it_is_named_with_its_size_and_springs_keep_theirs(cause: Cause, name: str) -> None:
    springs = base_model(load_robot("motoman_sk120"))
    assert springs is not None
    options = Options(only=("base_rocking", "tool_compliance", *OTHERS))
    answer = answered(springs, hidden(cause, poses=12), options=options)
    assert [finding.effect.id for finding in answer.findings] == [name]
    for spring, true in zip(answer.final.parameters, sk120().typical.joint.values(), strict=False):
        assert abs(spring.value - true) < 3.5 * spring.std
    soft = [p for p in answer.final.parameters if p.effect.id == name and p.internal > 1e-5]
    sizes = sorted(size for size in cause.sizes.values() if size)
    for found, true in zip(sorted(soft, key=lambda p: p.internal), sizes, strict=True):
        assert abs(found.internal - true) < 3.5 * found.internal_std
