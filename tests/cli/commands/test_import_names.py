"""`sk120stiff import` of files that belong together by names: what lacks a partner is told."""

from pathlib import Path

from tests.measurements.importers.tracked import (
    Campaign,
    campaign,
    joints_file,
    spatial_analyzer,
    ur5,
)


def test_names_without_a_point_are_few_and_in_their_order(run, tmp_path: Path) -> None:
    """P2 comes before P10, and of fifteen names the first are shown."""
    seen = campaign(20)
    kept = [k for k in range(20) if k % 4]
    part = Campaign(tuple(seen.names[k] for k in kept), seen.q[kept], seen.x[kept])
    points = spatial_analyzer(tmp_path, Campaign(part.names[:9], part.q[:9], part.x[:9]))
    joints = str(joints_file(tmp_path, seen))
    given = ("import", str(points), "--joints-file", joints, "--robot", ur5(), "--preview")
    outcome = run(*given)
    assert outcome.code == 0, outcome.stderr
    assert "Left out, 11 rows:" in outcome.stdout
    shown = "- P1, P5, P9, P13, P14, P15, P16, P17 and 3 more of joints.csv: no point"
    assert shown in outcome.stdout
    reasons = {entry["reason"] for entry in run(*given, "--json").document["skipped"]}
    left = set(seen.names) - set(part.names[:9])
    assert reasons == {f"{name} of joints.csv: no point" for name in left}
