"""Every slip in the YAML file beside the readings: its line, its key and what to write."""

from pathlib import Path

import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements import read_measurements

GOOD = "pose,q1[deg],fx[N],fy[N],fz[N],dx[mm],dy[mm],dz[mm]\n1,0,1,0,0,1,0,0\n"

YAML = {
    "force without frame": (
        "robot: a\nforce: {point: {xyz: [0, 0, 1], unit: m}}\n",
        ["line 2", "'force.frame' is missing", "force: {frame: base"],
    ),
    "force with an empty frame": ("force: {frame: }\n", ["line 1", "'force.frame' is missing"]),
    "not yaml": ("robot: motoman_sk120\nforce: {frame: base\nnoise: 3\n", ["line 3", "not YAML"]),
    "tab": ("robot: a\nforce:\n\tframe: base\n", ["line 3", "not YAML"]),
    "a list": ("- robot\n", ["holds no keys", "robot"]),
    "text": ("nothing\n", ["holds no keys"]),
    "unknown key": (
        "robot: a\nnoize: {sigma: 1}\n",
        ["line 2", "'noize'", "did you mean 'noise'", "displacement"],
    ),
    "unknown key inside": (
        "noise:\n  unit: um\n  sigm: 1\n",
        ["line 3", "'noise.sigm'", "did you mean 'sigma'", "growth"],
    ),
    "key twice": ("source: a\nsource: b\n", ["line 2", "'source'", "twice"]),
    "force frame": (
        "force:\n  frame: world\n",
        ["line 2", "key force.frame", "'world'", "'base' or 'tool'"],
    ),
    "displacement frame": (
        "displacement: {frame: link_1}\n",
        ["line 1", "'link_1'", "'base' or 'tool'"],
    ),
    "zero": ("displacement: {zero: common}\n", ["'common'", "'shared', 'separate' or 'unknown'"]),
    "point without unit": (
        "\npoint: {xyz: [1, 2, 3]}\n",
        ["line 2", "'point.unit' is missing", "unit: mm"],
    ),
    "point of two": ("point: {xyz: [1, 2], unit: mm}\n", ["line 1", "key point.xyz"]),
    "point of text": ("point: {xyz: [1, 2, up], unit: mm}\n", ["key point.xyz", "'up'"]),
    "point in newton": (
        "point: {xyz: [1, 2, 3], unit: N}\n",
        ["line 1", "not a unit of length", "mm"],
    ),
    "point infinite": ("point: {xyz: [1, 2, .inf], unit: mm}\n", ["key point.xyz", "finite"]),
    "force point unit": (
        "force: {frame: base, point: {xyz: [1, 2, 3], unit: yards}}\n",
        ["force.point.unit", "'yards'"],
    ),
    "negative sigma": ("noise: {sigma: -1, unit: um}\n", ["line 1", "key noise.sigma", "-1"]),
    "sigma of zero": ("noise: {sigma: 0, unit: um}\n", ["noise.sigma"]),
    "sigma with its unit": (
        "noise: {sigma: 10 um}\n",
        ["noise.sigma", "'10 um'", "sigma: 10, unit: um"],
    ),
    "sigma without unit": ("noise:\n  sigma: 10\n", ["line 1", "the unit is missing", "um"]),
    "growth": ("noise: {growth: 10}\n", ["noise.growth", "10"]),
    "noise is a number": ("noise: 10\n", ["line 1", "key noise", "{sigma: 10, unit: um}"]),
    "robot is a number": ("robot: 120\n", ["line 1", "key robot", "120"]),
}


@pytest.mark.parametrize("case", YAML)
def test_yaml(tmp_path: Path, case: str) -> None:
    text, parts = YAML[case]
    (tmp_path / "data.csv").write_text(GOOD)
    (tmp_path / "data.yaml").write_text(text)
    with pytest.raises(InputError) as caught:
        read_measurements(tmp_path / "data.csv")
    assert caught.value.exit_code == 2
    assert caught.value.remedy
    assert str(tmp_path / "data.yaml") in str(caught.value.where)
    for part in parts:
        assert part in str(caught.value)


def test_yaml_that_is_not_text(tmp_path: Path) -> None:
    (tmp_path / "data.csv").write_text(GOOD)
    (tmp_path / "data.yaml").write_bytes(b"source: caf\xe9\n")
    with pytest.raises(InputError, match=r"data\.yaml, line 1.*UTF-8"):
        read_measurements(tmp_path / "data.csv")


def test_two_settings_files(tmp_path: Path) -> None:
    (tmp_path / "data.csv").write_text(GOOD)
    (tmp_path / "data.yaml").write_text("")
    (tmp_path / "data.yml").write_text("")
    with pytest.raises(InputError, match="side by side"):
        read_measurements(tmp_path / "data.csv")
