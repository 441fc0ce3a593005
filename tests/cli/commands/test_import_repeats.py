"""Rows that were read again at a pose, imported."""

from pathlib import Path

import numpy as np

from tests.measurements.importers.tracked import campaign, ur5

SEEN = campaign()


def test_what_is_read_again_tells_no_more_of_the_frame(run, tmp_path: Path) -> None:
    head = "j1[deg],j2[deg],j3[deg],j4[deg],j5[deg],j6[deg],x[mm],y[mm],z[mm]"
    rows = [",".join(f"{v:.6f}" for v in row) for row in np.hstack([SEEN.q, SEEN.x])]
    told = []
    for times in (1, 3):
        path = tmp_path / f"{times}.csv"
        path.write_text("\n".join([head, *(row for row in rows for _ in range(times))]))
        given = ("import", str(path), "--robot", ur5(), "--tool", "tool0", "--preview")
        told.append(run(*given, "--json").document["registration"]["std_shift_m"])
    np.testing.assert_allclose(told[1], told[0], rtol=0.05)
    assert "rms of 120 readings at 40 poses" in " ".join(run(*given).stdout.split())
