"""What springs make of positions beside the errors of all joint frames, to first order.

For slips of a whole file, which move every reading: gravity that points elsewhere, forces with the
other sign or in other axes. Springs are fitted as each of them would have it; frames, and waves
over all joints' angles, take what they can in any case.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from scipy.optimize import lsq_linear, nnls

from sk120stiff.arrays import Array, Mask
from sk120stiff.effects import Effect, Elastic
from sk120stiff.effects.joint_frame import JointFrame
from sk120stiff.effects.joint_springs import JointSprings
from sk120stiff.effects.options import Options
from sk120stiff.effects.transmission_error import TransmissionError
from sk120stiff.identify.checks.left_over import orthonormal
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.positions.omitted.other_causes import slopes
from sk120stiff.identify.positions.solve.pose_problem import PoseProblem
from sk120stiff.model import Model

ROUNDING = 1e-9  # of the largest number, below which springs make nothing


@dataclass(frozen=True, eq=False)
class BesideFrames:
    """Readings without what frames can take, as few numbers.

    Attributes:
        along: (k, r, n) readings per compliance of every drive, under each of k stated loads.
        gap: (r,) what is to be explained.
        freedom: Numbers beyond those of frames and springs.
        softest: (n,) compliances that no drive exceeds.
        others: (r, p) readings per parameter of each further cause that was asked about.
    """

    along: Array
    gap: Array
    freedom: int
    softest: Array
    others: tuple[Array, ...] = ()

    def square(self, along: Array) -> float:
        """What springs leave of the gap's square with columns (r, n); none of them pushes."""
        return float(nnls(along, self.gap)[1] ** 2)

    def within(self, along: Array) -> float:
        """The same with springs no softer than any drive."""
        return square_within(along, self.gap, self.softest)


def square_within(along: Array, gap: Array, softest: Array) -> float:
    """What springs leave of the square of a gap (r,) that are no softer than any drive.

    Few poses leave so little of a wrist beside the frames that only absurd ones would show.

    Args:
        along: (r, n) readings per compliance.
        gap: (r,) what is to be explained.
        softest: (n,) compliances that no drive exceeds.
    """
    size = np.maximum(np.linalg.norm(along, axis=0), 1e-300)
    whole = max(float(np.linalg.norm(gap)), 1e-300)
    least = lsq_linear(along / size, gap / whole, (0.0, softest * size / whole), method="bvls")
    return 2.0 * whole**2 * float(least.cost)


def without_springs(model: Model) -> Model:
    """The model of an arm in which nothing yields."""
    for effect in model.effects:
        if isinstance(effect, Elastic):
            model = model.without(effect.id)
    return model


def _of_springs(model: Model) -> Mask:
    """(P,) parameters that are compliances of drives."""
    return np.array([isinstance(p.effect, JointSprings) for p in model.parameters], dtype=np.bool_)


def beside_frames(
    found: Calibration,
    loads: Sequence[Callable[[PoseProblem], PoseProblem]],
    causes: Sequence[Effect] = (),
) -> BesideFrames:
    """Springs about the rigid arm where a calibration has placed it.

    Args:
        found: The calibration.
        loads: What is to be stated otherwise, each as a change of the problem.
        causes: What else may be at work, as everything is stated.
    """
    model = without_springs(found.model)
    robot, white = model.robot, found.problem.of_channels.apply
    present = {effect.id for effect in model.effects}
    beside, springs = (
        [kind.at(robot, where, Options()) for kind in kinds for where in kind.places(robot)]
        for kinds in ((JointFrame, TransmissionError), (JointSprings,))
    )
    bare = model
    for effect in (*(each for each in beside if each.id not in present), *springs):
        model = model + effect
        bare = bare + effect if effect in springs else bare
    problem = replace(found.problem, model=model)
    lean = replace(found.problem, model=bare)

    def columns(problem: PoseProblem) -> tuple[Array, Array]:
        gap, slope = problem.channel_gap(problem.model.values, derivative=True)
        return np.asarray(white(gap)), np.asarray(white(slope))

    gap, slope = columns(problem)
    Q = orthonormal(slope[:, ~_of_springs(model)], ROUNDING)
    own = _of_springs(bare)
    parts = [columns(otherwise(lean))[1][:, own] for otherwise in loads]
    further = slopes(problem, model, causes)
    blocks = [white(further[cause]) for cause in causes]
    whole = np.column_stack([*parts, *blocks, gap])
    for _ in range(2):
        whole = whole - Q @ (Q.T @ whole)
    R = np.asarray(np.linalg.qr(whole)[1])
    n = int(own.sum())
    along = np.array([R[:, k * n : (k + 1) * n] for k in range(len(parts))])
    ends = np.cumsum([len(parts) * n, *(block.shape[1] for block in blocks)])
    others = tuple(R[:, a:b] for a, b in pairwise(ends))
    softest = np.array([p.spec.plausible for p in bare.parameters])[own]
    return BesideFrames(along, R[:, -1], len(gap) - Q.shape[1] - n, softest, others)
