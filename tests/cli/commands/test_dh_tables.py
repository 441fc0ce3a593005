"""DH tables by the command line: what `export` writes is a robot, readings are none."""

import numpy as np
import pytest

import sk120stiff as sk


@pytest.mark.parametrize("name", ["ur5e", "motoman_sk120"])
@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_what_export_writes_is_read_back(run, tmp_path, name, convention):
    """Rows of Hayati's, axes that coincide and a joint that follows another among them."""
    assert run("export", name, "--out", str(tmp_path / "whole.csv")).code == 0
    header, *lines = (tmp_path / "whole.csv").read_text().splitlines()
    kept = [line for line in lines if line.startswith(convention)]
    (tmp_path / "part.csv").write_text("\n".join([header, *kept]))
    table, robot = sk.load_robot(tmp_path / "part.csv"), sk.load_robot(name)
    whole = sk.load_robot(tmp_path / "whole.csv")
    assert table.actuated == whole.actuated == robot.actuated
    for q in np.random.default_rng(5).uniform(-1.0, 1.0, (10, 6)):
        np.testing.assert_allclose(table.placement(q), robot.placement(q), atol=1e-12)
        np.testing.assert_allclose(whole.placement(q), robot.placement(q), atol=1e-12)


def test_the_command_line_takes_a_table_for_a_robot_and_readings_for_none(run, tmp_path):
    (tmp_path / "arm.csv").write_text(
        "convention,theta[deg],d[mm],a[mm],alpha[deg]\nstandard,0,162.5,0,90\nstandard,0,0,-425,0\n"
    )
    assert run("check", str(tmp_path / "arm.csv")).code == 0
    readings = sk.bundled_robots()["motoman_sk120"] / "data" / "table2_measured.csv"
    refused = run("check", str(readings))
    assert refused.code == 2
    assert "no robot and no model file" in refused.stderr
