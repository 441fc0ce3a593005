"""A bounded part of `scripts/attacks.py`: the same mutations, fewer seeds."""

from pathlib import Path

import pytest

from tests.attacks.inputs import COMMANDS, mutated_inputs

# Seeds at which the program once failed, beside the first ones.
KNOWN = {"m.csv": (1070, 1280), "mod.yaml": (13, 20, 33, 34), "rob/robot.yaml": (59,),
         "rob/sk120.urdf": (6, 1160), "path.csv": (1121,)}  # fmt: skip


@pytest.mark.parametrize("kind", COMMANDS)
def test_mutated_files_are_answered_or_refused(kind: str, tmp_path: Path) -> None:
    seeds = [range(15), *(range(seed, seed + 1) for seed in KNOWN.get(kind, ()))]
    found = [
        verdict
        for number, some in enumerate(seeds)
        for verdict in mutated_inputs(tmp_path / str(number), kind, some, explain_every=1000)
    ]
    assert [verdict for verdict in found if verdict.loss] == []
    assert len(found) == sum(map(len, seeds))
