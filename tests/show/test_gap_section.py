"""The gap per pose where there are too many poses for bars."""

from types import SimpleNamespace

import numpy as np
import pytest

from sk120stiff.show.stories import gap_section

FIT = SimpleNamespace(
    problem=SimpleNamespace(load_cases=SimpleNamespace(poses=tuple(map(str, range(400)))))
)


@pytest.mark.parametrize(
    ("names", "end"),
    [(("model",), "is 673 µm."), (("before", "after"), "is 673 µm before, 673 µm after.")],
)
def test_one_model_is_not_named(monkeypatch, names: tuple[str, ...], end: str) -> None:
    monkeypatch.setattr(gap_section, "pose_rms", lambda fit, model: np.full(400, 673e-6))
    said = gap_section._per_pose(FIT, dict.fromkeys(names), None)
    assert said.endswith(f"the largest gap of one {end}")
