"""Are the draws of single poses what their name says: constants, of no joint?"""

from __future__ import annotations

import numpy as np

from sk120stiff.effects import Effect
from sk120stiff.errors import Refusal
from sk120stiff.explain.judge.budget import brought
from sk120stiff.explain.localise.localisation import OwnAtPoses
from sk120stiff.explain.localise.places import localise
from sk120stiff.explain.select.size_prices import price_of_sizes
from sk120stiff.explain.select.stepwise import Selection, refit

ALONG = 0.75  # share of draws' square along one direction, of which chance gives a third


def joint_that_turns(found: Selection, effect: Effect) -> str | None:
    """The joint along whose turn the draws of an effect lie; None: of no joint.

    A gear that rubs begins a pose with what the pose before left in it, and one whose stiffness
    goes with its angle yields more at some poses. Draws of the tracker know no joint: a third of
    their square lies along its turn. Readings that lack an axis tell nothing of a direction.
    """
    if not effect.random_effects:
        return None
    fit = found.final
    load_cases = fit.problem.load_cases
    drawn = np.einsum("nij,nj->ni", load_cases.reading_axes, brought(fit, effect.id))
    whole = fit.problem.read.all(axis=1)
    drawn, ways = drawn[whole], load_cases.nominal.linear_jacobian[whole]
    length = np.maximum(np.linalg.norm(ways, axis=1), 1e-300)
    along = (np.einsum("ni,nij->nj", drawn, ways) / length) ** 2
    joint = int(np.argmax(along.sum(axis=0)))
    if along[:, joint].sum() > ALONG * (drawn**2).sum():
        return load_cases.robot.actuated[joint]
    return None


def is_constant(found: Selection, effect: Effect) -> bool:
    """Is what single poses have of their own a constant, and not in proportion to the load?

    Draws, one for every pose, can imitate part of any cause that the catalogue lacks.
    """
    rest = [other for other in found.effects if other != effect]
    try:
        without = refit(found.base, rest, found.final)
    except Refusal:
        return True  # the other effects need it beside them, so there is nothing to compare
    own = {each.name: each for each in localise(without).own}
    if not {"constant", "proportional"} <= own.keys():
        return True

    def evidence(each: OwnAtPoses) -> float:
        return each.statistic - float(price_of_sizes(each.statistic, each.freedom, np.inf))

    return evidence(own["constant"]) > evidence(own["proportional"])
