"""What follows from an answer: what the readings could not have shown, what to measure next."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.errors import Refusal
from sk120stiff.explain.advise.detectable import detectable
from sk120stiff.explain.answer.explanation import Explanation
from sk120stiff.explain.candidates.regression import Regression
from sk120stiff.explain.localise.places import localise
from sk120stiff.explain.localise.words import where_sentences
from sk120stiff.plan import Cell, cell_from_data, discriminating_readings, feasible_pool

READINGS_TO_MEASURE = 10  # proposed: half a day with a tracker
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
        told = {} if following is None else {"next_remarks": following[2]}
    except Refusal as error:  # nothing that can be driven or held: the answer stands without
        following, told = None, {"next_remarks": (f"No poses to measure next: {error}",)}
    return replace(
        answer,
        where=where_sentences(found),
        details={**answer.details, "localisation": found, **told},
        smallest_detectable=smallest,
        not_observable=invisible,
        next_poses=None if following is None else following[:2],
    )


def next_poses(
    answer: Explanation, *, seed: int, count: int = READINGS_TO_MEASURE, cell: Cell | None = None
) -> tuple[np.ndarray, np.ndarray, tuple[str, ...]] | None:
    """Poses (K, n) and wrenches (K, 6) that tell the first unsettled pair of names apart.

    With them what is to be said of the loads: where motors limit them, and what was not checked.

    They keep to the cell; where it names no floor or rig they go no lower than the poses that were
    measured, and loads come as they did: what was measured could be driven.

    Raises:
        Refusal: Nothing else can be driven or held there.
    """
    unheld = ""
    for finding in answer.findings:
        rivals = [name for name in finding.alternatives if name not in finding.exact]
        if not rivals:
            continue
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
        rival = answer.effect(rivals[0])
        sigma = answer.noise.sigma * answer.final.noise_factor
        for share in SHARES_OF_LOAD:
            weaker = replace(pool.load_cases, wrench=share * pool.load_cases.wrench)
            weaker = weaker.rows(within.rig.has(np.linalg.norm(weaker.wrench[:, :3], axis=1)))
            if not weaker.count:  # the rig has no such steps
                continue
            held = replace(pool, load_cases=weaker)
            try:
                choice = discriminating_readings(
                    model, finding.effect, rival, held, count=count, sigma=sigma
                )
            except Refusal:  # a curve beyond the torques at which it was measured may not hold
                continue
            rows = list(choice.rows)
            return weaker.a[rows], weaker.wrench[rows], pool.remarks
        unheld = unheld or f"{finding.effect.id} from {rivals[0]}"
    if unheld:
        raise Refusal(
            f"no load down to {100 * SHARES_OF_LOAD[-1]:.0f} % of {force:.4g} N that the rig has "
            f"and the model holds tells {unheld}",
            remedy="Give the rig smaller steps, or plan by 'sk120stiff plan --between'.",
        )
    return None
