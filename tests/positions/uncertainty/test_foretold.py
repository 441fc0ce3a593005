"""Positions at poses that no fit saw are as far off as is said of them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

import sk120stiff as sk
from sk120stiff.identify import known_model
from tests.positions.arm import errors, poses, tracked, urdf, write
from tests.positions.missing_cause import FIT, YIELDS

SIGMA = 2e-5
SLIDE = (
    '<link name="carriage"/><joint name="slide" type="prismatic"><parent link="base"/>'
    '<child link="carriage"/><axis xyz="0 0 1"/>'
    '<limit lower="0" upper="1" effort="1" velocity="1"/></joint>'
)


def test_beside_a_cause_that_the_model_lacks(tmp_path: Path) -> None:
    """Springs that stand for a base that rocks were each uncertain for itself: ± was 6 gaps."""
    off = []
    for seed in range(3):
        arm, a, b = errors(seed), poses(50, seed), poses(200, seed + 50)
        arm.rocks = YIELDS
        noise = SIGMA * np.random.default_rng(seed).normal(size=(250, 3))
        x = tracked(arm.stands(np.vstack([a, b]))[0]) + noise
        (tmp_path / f"{seed}").mkdir()
        data = sk.read(write(tmp_path / f"{seed}", a, x[:50], FIT))
        found = sk.fit(sk.base_model(sk.load_robot(data.robot, base="base", tool="tool")), data)
        assert found.lacks
        (tmp_path / f"{seed}b").mkdir()
        other = sk.read(write(tmp_path / f"{seed}b", b, x[50:], FIT))
        said = sk.predict(known_model(found), other)
        assert said.std is not None
        off.append(said.gap(other) / np.hypot(said.std, SIGMA))
    size = float(np.sqrt(np.mean(np.square(off))))
    assert 0.6 < size < 1.3
    assert (np.abs(off) < 1.96).mean() > 0.9


def test_what_does_not_show_does_not_show_in_what_is_foretold(tmp_path: Path) -> None:
    """An upright slide sags by the same at every pose: its spring is the tracker's height."""
    arm, a = errors(2), poses(40, 2)
    a[:, 3], a[:, 4] = (
        0.0,
        0.5 * np.pi - a[:, 1] - a[:, 2],
    )  # the tool hangs: its length is hardly seen
    a[:, 3:5] += 0.0003 * np.random.default_rng(4).normal(size=(40, 2))
    height = np.random.default_rng(2).uniform(0.0, 1.0, 40)
    x = arm.stands(a)[0] + height[:, None] * [0.0, 0.0, 1.0]
    x = tracked(x) + SIGMA * np.random.default_rng(3).normal(size=x.shape)
    path = write(tmp_path, a, x, f"{FIT}noise: {{sigma: 20, unit: um}}\n")
    table = path.read_text().splitlines()
    lines = [f"slide[mm],{table[0]}"]
    lines += [f"{1e3 * h:.10g},{row}" for h, row in zip(height, table[1:], strict=True)]
    path.write_text("\n".join(lines) + "\n")
    on_slide = urdf().replace('<parent link="base"/>', '<parent link="carriage"/>', 1)
    on_slide = on_slide.replace('<link name="base"/>', f'<link name="base"/>{SLIDE}', 1)
    (tmp_path / "six.urdf").write_text(on_slide)
    data = sk.read(path)
    model = sk.base_model(sk.load_robot(data.robot, base="base", tool="tool"))
    found = sk.fit(model, data)
    known = known_model(found).uncertainty
    assert known is not None
    slide = known.names.index("joint_springs:slide.stiffness")
    (way,) = [row for row in known.unseen if abs(row[slide]) > 1e-9]
    problem = found.problem
    slope = problem.channel_gap(problem.values(found.x), derivative=True)[1][:, problem.free]
    assert np.abs(slope @ way).max() < 1e-3 * SIGMA
    alone = np.where(np.arange(len(way)) == slide, way, 0.0)
    assert np.abs(slope @ alone).max() > 10.0 * SIGMA
    said = sk.predict(known_model(found), data)
    assert said.std is not None and np.isfinite(said.std).all()
    nowhere = replace(known, unseen=alone[None])
    blind = sk.predict(found.model.known(nowhere), data)
    assert blind.std is not None and np.isinf(blind.std).any()
