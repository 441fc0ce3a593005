"""What follows from an answer: what the readings could not have shown, what to measure next."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import zip_longest
from typing import NamedTuple

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import Refusal
from sk120stiff.explain.advise.detectable import detectable
from sk120stiff.explain.answer.explanation import Explanation
from sk120stiff.explain.candidates.regression import Regression
from sk120stiff.explain.findings import Apart
from sk120stiff.explain.localise.places import localise
from sk120stiff.explain.localise.words import where_sentences
from sk120stiff.plan import (
    Cell,
    Pool,
    cell_from_data,
    feasible_pool,
    readings_for_all,
    signature_columns,
)
from sk120stiff.plan.design import DISPLACEMENT

READINGS_TO_MEASURE = 10  # proposed: half a day with a tracker
PAIRS = 6  # of names that the proposed readings are to tell apart
SHARES_OF_LOAD = (1.0, 0.5, 0.25, 0.1)  # tried until the model holds the load at every pose


def completed(
    answer: Explanation, regression: Regression, *, seed: int, cell: Cell | None = None
) -> Explanation:
    """The answer with where the gap lives, detectable sizes, what is hidden, the next poses."""
    smallest, invisible = detectable(answer, regression)
    # Within poses the springs alone leave part of the cause: the noise is what the answer says.
    alike = answer.final.problem.noise == answer.base.problem.noise
    found = localise(answer.base, answer.yardstick if alike else None)
    try:
        following = next_poses(answer, seed=seed, cell=cell)
        told = {} if following is None else {"next_remarks": following.remarks}
    except Refusal as error:  # nothing that can be driven or held: the answer stands without
        following, told = None, {"next_remarks": (f"No poses to measure next: {error}",)}
    return replace(
        answer,
        where=where_sentences(found),
        details={**answer.details, "localisation": found, **told},
        smallest_detectable=smallest,
        not_observable=invisible,
        next_poses=None if following is None else (following.a, following.wrench),
        next_pairs=() if following is None else following.pairs,
    )


class NextPoses(NamedTuple):
    """What to measure next.

    Attributes:
        a, wrench: (K, n) poses and (K, 6) loads.
        remarks: Where motors limit the loads, and what was not checked.
        pairs: Which names they tell apart, and how far.
    """

    a: Array
    wrench: Array
    remarks: tuple[str, ...]
    pairs: tuple[Apart, ...]


def next_poses(answer: Explanation, *, seed: int, cell: Cell | None = None) -> NextPoses | None:
    """Poses and loads that tell all unsettled pairs of names apart; None where nothing is open.

    The pairs share the readings. They keep to the cell; where it names no floor or rig they go no
    lower than the poses that were measured, and loads come as they did: what was measured could be
    driven.

    Raises:
        Refusal: Nothing else can be driven or held there.
    """
    pairs = open_pairs(answer)
    if not pairs:
        return None
    load_cases = answer.final.problem.load_cases
    model = answer.final.model
    force = float(np.linalg.norm(load_cases.wrench[:, :3], axis=1).max())
    within = cell_from_data(
        model.robot, cell or Cell(), load_cases.a, load_cases.wrench, load_cases.point
    )
    pool = feasible_pool(
        model.robot,
        poses=400,
        directions=3,
        force=max(force, 1.0),
        point=load_cases.point,
        force_point=load_cases.force_point,
        seed=seed,
        cell=within,
    )
    held: dict[tuple[str, str], Array] = {}
    for share in SHARES_OF_LOAD:
        weaker = replace(pool.load_cases, wrench=share * pool.load_cases.wrench)
        weaker = weaker.rows(within.rig.has(np.linalg.norm(weaker.wrench[:, :3], axis=1)))
        if not weaker.count:  # the rig has no such steps
            continue
        found = _signatures(answer, pairs, replace(pool, load_cases=weaker))
        if len(found) > len(held):
            held, cases = found, weaker
        if len(held) == len(pairs):
            break
    if not held:
        name, rival = pairs[0]
        raise Refusal(
            f"no load down to {100 * SHARES_OF_LOAD[-1]:.0f} % of {force:.4g} N that the rig has "
            f"and the model holds tells {name} from {rival}",
            remedy="Give the rig smaller steps, or plan by 'sk120stiff plan --between'.",
        )
    sigma = DISPLACEMENT * answer.noise.sigma * answer.final.noise_factor
    columns = [block / sigma for block in held.values()]
    chosen, apart = readings_for_all(columns, count=READINGS_TO_MEASURE)
    told = tuple(Apart(*pair, float(size)) for pair, size in zip(held, apart, strict=True))
    rows = list(chosen)
    return NextPoses(cases.a[rows], cases.wrench[rows], pool.remarks, told)


def open_pairs(answer: Explanation) -> list[tuple[str, str]]:
    """Names and what stands beside them, no more than `PAIRS`: of every place the nearest first."""
    places = [[(each.effect.id, name) for name in each.others] for each in answer.findings]
    ranked = [pair for row in zip_longest(*places) for pair in row if pair is not None]
    return ranked[:PAIRS]


def _signatures(
    answer: Explanation, pairs: Sequence[tuple[str, str]], pool: Pool
) -> dict[tuple[str, str], Array]:
    """(M, 3, k) columns of every pair at the loads of a pool that the model holds [m]."""
    named = {finding.effect.id: finding.effect for finding in answer.findings}
    found = {}
    for name, rival in pairs:
        # a curve beyond the torques at which it was measured may not hold
        with suppress(Refusal):
            found[name, rival] = signature_columns(
                answer.final.model, named[name], answer.effect(rival), pool
            )
    return found
