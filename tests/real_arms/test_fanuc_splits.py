"""A cheap part of scripts/18_fanuc_splits.py: two of its splits; not collected without the data."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np
import pytest

from tests.real_arms import fanuc

if fanuc.FOLDER.is_dir():

    @pytest.mark.parametrize(("number", "sigma"), [(1, 30e-6), (3, None)])
    def test_three_quarters_of_the_poses_say_the_same_and_foretell_the_rest(
        tmp_path: Path, number: int, sigma: float | None
    ) -> None:
        place = Path(__file__).parents[2] / "scripts" / "18_fanuc_splits.py"
        script = runpy.run_path(str(place))
        model, data = script["readings"](fanuc.FOLDER, tmp_path, sigma)
        split = script["split"](model, data, number)
        first = split.answer.findings[0]
        assert {"joint_tilt:joint_3", "link_bending:link_3"} <= {
            first.effect.id,
            *first.alternatives,
        }
        assert all(np.isfinite(p.value) for p in split.answer.final.parameters[:3])
        assert script["rms"](split.named) < 0.95 * script["rms"](split.springs)
