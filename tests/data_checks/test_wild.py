"""One reading that is far off outweighs all others: it is set aside, and the arm is explained."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.data_checks import look, refuse_unbelievable, without_wild
from sk120stiff.errors import Refusal
from sk120stiff.measurements import Measurements
from tests.data_checks.readings import ARMS, Arm, spoilt


def with_wild(arm: Arm, rows: list[int], size: float, seed: int = 3) -> Measurements:
    rng, d = np.random.default_rng(seed), arm.readings.displacement.copy()
    way = rng.normal(size=(len(rows), 3))
    d[rows] += size * way / np.linalg.norm(way, axis=1, keepdims=True)
    return replace(arm.readings, displacement=d)


@pytest.mark.parametrize(("arm", "size"), list(zip(ARMS, [0.02, 11.0], strict=True)))
@pytest.mark.parametrize("rows", [[7], [3, 20], [1, 2, 30, 41]])
def test_wild_rows_are_found_and_no_others(arm: str, size: float, rows: list[int]) -> None:
    known = ARMS[arm]()
    data = with_wild(known, rows, size)
    with pytest.raises(Refusal, match="this arm explains only"):
        refuse_unbelievable(look(known.model, data), known.model, data)
    sound, said = without_wild(known.robot, data)
    assert np.flatnonzero(data.use & ~sound.use).tolist() == rows
    assert said is not None and said.count("pose ") == len(rows) and "set aside" in said
    refuse_unbelievable(look(known.model, sound), known.model, sound)


@pytest.mark.parametrize("arm", ARMS)
def test_sound_and_hopeless_readings_stay_as_they_are(arm: str) -> None:
    known = ARMS[arm]()
    same, said = without_wild(known.robot, known.readings)
    assert said is None and same.use.all()
    for garbage in ("shuffled", "random"):
        data = spoilt(known, garbage)
        same, said = without_wild(known.robot, data)
        assert said is None and same.use.all(), garbage
    many = with_wild(known, list(range(0, known.readings.n_readings, 5)), 0.05)
    assert without_wild(known.robot, many)[1] is None  # every fifth is no slip any more
