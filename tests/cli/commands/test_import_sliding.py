"""A joint that slides is told in lengths."""

from __future__ import annotations

from pathlib import Path

LINKS = "".join(f'<link name="{name}"/>' for name in ("base", "a", "b", "tool"))
JOINTS = "".join(
    f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
    f'<origin xyz="0.1 0.2 0.3"/><axis xyz="{axis}"/>'
    '<limit lower="-2" upper="2" effort="1" velocity="1"/></joint>'
    for name, kind, parent, child, axis in (
        ("rail", "prismatic", "base", "a", "0 0 1"),
        ("elbow", "revolute", "a", "b", "0 0 1"),
        ("wrist", "revolute", "b", "tool", "0 1 0"),
    )
)
TABLE = "rail,elbow,wrist,x,y,z\n100,10,20,1200,400,900\n200,30,-20,1100,500,950\n"


def test_its_unit_and_option_are_those_of_lengths(run, tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(f'<robot name="arm">{LINKS}{JOINTS}</robot>')
    (tmp_path / "points.csv").write_text(TABLE)
    out = run(
        "import", str(tmp_path / "points.csv"), "--robot", str(tmp_path / "arm.urdf"),
        "--length", "mm", "--angle", "deg", "--preview",
    ).stdout  # fmt: skip
    rows = {cells[0]: cells[-2:] for line in out.splitlines() if (cells := line.split())}
    assert rows["rail"] == ["mm", "--length"]
    assert rows["elbow"] == ["deg", "--angle"]
