"""Springs that are others from some pose on: screws that came loose, or two arms in one file.

The strongest of all places in the order of the poses is held against the strongest of as many
places in orders drawn by chance, in which a change of the arm has no part (permutation test: Fisher
1935). So nothing is taken for granted of what is left, be it noise or an error of the model.
"""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.explain.localise.changes import cuts
from sk120stiff.identify.checks.left_over import orthonormal
from sk120stiff.identify.positions.calibrate import Calibration

PLACES = 60  # at which a change is looked for
WORTH = 0.2  # of what is left, which a change has to take off to be told
DRAWN = 199  # orders by chance
CHANCE = 0.01  # share of them that may show as much


def changed(final: Calibration, seed: int) -> tuple[str, ...]:
    """From which pose on springs are others, and what that may be, in a sentence."""
    problem = final.problem
    moving = ~final.at_bound
    springs = [k for k, p in enumerate(final.parameters) if p.effect.joint_spring and moving[k]]
    places = [*cuts(problem.load_cases, PLACES)]
    if not springs or not places or final.degrees_of_freedom <= len(springs):
        return ()
    inside = orthonormal(final.jacobian[:, moving])
    columns, rows = final.jacobian[:, springs], problem.rows
    white = final.residual - inside @ (inside.T @ final.residual)
    after = np.array([place.after for place in places])  # (C, N)
    shares = _shares(after[:, rows], columns, white, inside)
    best = int(np.argmax(shares))
    if shares[best] < WORTH:
        return ()
    pose, rng = problem.load_cases.pose, np.random.default_rng(seed)
    _, first, back = np.unique(pose, return_index=True, return_inverse=True)
    other = [
        after[:, first][:, rng.permutation(len(first))][:, back.reshape(-1)] for _ in range(DRAWN)
    ]
    as_much = sum(
        _shares(each[:, rows], columns, white, inside).max() >= shares[best] for each in other
    )
    if (1 + as_much) / (1 + DRAWN) > CHANCE:
        return ()
    label = places[best].pose
    return (
        f"The springs are others from pose {label} on than before: that takes off "
        f"{100.0 * shares[best]:.0f} % of the square of what is left. Find out what came loose, "
        "was tightened or let go there, or whether positions of two arms stand in one file, and "
        "run this on both parts, each by itself (column use: 0 leaves a row out).",
    )


def _shares(after: Array, columns: Array, white: Array, inside: Array) -> Array:
    """(C,) share of what is left that the springs take off if they are others where `after` is 1.

    Args:
        after: (C, M) for every number.
        columns: (M, k) of the springs, whitened.
        white: (M,) what is left, whitened, without what the (M, r) `inside` can do.
        inside: An orthonormal basis.
    """
    total = max(float(white @ white), 1e-300)
    out = []
    for step in after:
        own = columns * step[:, None]
        basis = orthonormal(own - inside @ (inside.T @ own))
        out.append(float(((basis.T @ white) ** 2).sum()) / total)
    return np.array(out)
