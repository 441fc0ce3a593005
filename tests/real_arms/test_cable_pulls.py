"""The public cable pulls through the controller's own columns; not collected where missing.

`tests/explain/test_beside_form.py` has what they lack.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from tests.real_arms import fanuc

if fanuc.FOLDER.is_dir():

    def test_the_controllers_columns_give_the_known_springs(
        tmp_path: Path,
    ) -> None:
        data = sk.read(fanuc.SCRIPT["converted"](fanuc.FOLDER, tmp_path))
        robot = sk.load_robot(str(tmp_path / "r2000ic.urdf"), base="base_link", tool="link_6")
        readings = data.with_joints(robot.actuated)
        assert np.abs(readings.joints - fanuc.MAPPED).max() < 1e-12
        rms = np.sqrt(3.0) * sk.fit(sk.base_model(robot), readings).rms
        assert rms == pytest.approx(0.372e-3, abs=0.002e-3)
