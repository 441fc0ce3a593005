"""A cheap part of scripts/18_fanuc_splits.py: one of its splits; not collected without the data."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np

from tests.real_arms import fanuc

if fanuc.FOLDER.is_dir():

    def test_three_quarters_of_the_poses_say_the_same_and_foretell_the_rest(
        tmp_path: Path,
    ) -> None:
        """With the tracker's noise stated, which the laws of no real arm keep to."""
        place = Path(__file__).parents[2] / "scripts" / "18_fanuc_splits.py"
        script = runpy.run_path(str(place))
        model, data = script["readings"](fanuc.FOLDER, tmp_path, 30e-6)
        split = script["split"](model, data, 1)
        pair = {"joint_tilt:joint_3", "link_bending:link_3"}
        told = [{each.effect.id, *each.alternatives} for each in split.answer.findings]
        assert any(pair & names for names in told), told
        assert set().union(*told) <= pair | {"joint_tilt:joint_2", "force_point:sensor"}
        assert all(np.isfinite(p.value) for p in split.answer.final.parameters[:3])
        assert split.answer.verdict in ("named", "ambiguous")
        assert split.answer.remainder.significant
        assert 100e-6 < split.answer.remainder.rms < 200e-6
        assert script["rms"](split.named) < 0.95 * script["rms"](split.springs)
