"""A smaller run of scripts/10_prediction_coverage.py: the ± of predictions is what it says."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff.identify.estimate import fit_displacements
from tests.identify.prediction_coverage import KINDS, Campaign, campaigns, share_inside

COUNT = 7  # campaigns of each kind
HOLD = (0.92, 0.98)


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[Campaign]]:
    folder = tmp_path_factory.mktemp("campaigns")
    return {kind.label: list(campaigns(kind, COUNT, 31, folder)) for kind in KINDS}


def test_intervals_at_new_poses_hold_the_deflections_of_another_hand(
    found: dict[str, list[Campaign]],
) -> None:
    """Where something is missing, seen or not. No reading tells an exact model from such a one."""
    lacking = {label: own for label, own in found.items() if "," in label}
    every = [campaign for own in lacking.values() for campaign in own]
    assert HOLD[0] <= share_inside(every)[0] <= HOLD[1]
    for label, own in lacking.items():
        share, error = share_inside(own)
        assert HOLD[0] - 3.0 * error <= share <= HOLD[1] + 3.0 * error, label
    # The same question put to intervals of another width would be answered with no.
    assert share_inside(every, narrower=1.4)[0] < HOLD[0]
    assert share_inside(every, narrower=0.6)[0] > HOLD[1]


def test_what_may_hide_beside_an_exact_model_is_less_than_the_noise_of_a_reading(
    found: dict[str, list[Campaign]],
) -> None:
    for label in ("SK120", "UR5"):
        own = found[label]
        assert share_inside(own)[0] >= HOLD[0]
        assert share_inside(own, remainder=False)[0] >= HOLD[0]
        hidden = [c.std_remainder.mean() / c.noise for c in own]
        assert 0.0 < np.mean(hidden) < 0.5, label


def test_what_is_missing_is_found_or_counts_by_what_may_hide(
    found: dict[str, list[Campaign]], tmp_path: Path
) -> None:
    for label, own in found.items():
        shown = np.mean([campaign.significant for campaign in own])
        if "missing" in label:
            assert shown > 0.8
            kind = next(each for each in KINDS if each.label == label)
            plain = [*campaigns(kind, COUNT, 31, tmp_path, fit_displacements)]
            alone, beside = (share_inside(each, remainder=False)[0] for each in (plain, own))
            assert alone < 0.5  # parameters by the noise alone say too little
            assert alone < beside < HOLD[0]  # with errors of poses they say more, and not all
        elif "faint" in label:
            assert shown < 0.7
            assert share_inside(own, remainder=False)[0] < 0.75
        else:
            assert shown < 0.3
