"""Do several laws of one gear together imitate one cause without a name?

A drive whose stiffness goes with its position, as beside a balancer with a spring, follows no law
of the torque. At few poses two such laws of its gear explain it together, each stands beside the
other, and in the place of one alone nothing does better. In the place of all of them a law of the
position may do as well: then the readings do not tell which of the two it is.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sk120stiff.effects import Effect
from sk120stiff.errors import listed
from sk120stiff.explain.judge.imitation import line_up_with
from sk120stiff.identify import Fit

WORTH_A_SENTENCE = 0.05  # probability from which on it is told


@dataclass(frozen=True)
class Imitated:
    """Names of one gear that may be one cause.

    Attributes:
        ids: The names.
        suspect: Completes the sentence "The gap goes with ...".
        probability: That it is that cause, and none of the names.
    """

    ids: tuple[str, ...]
    suspect: str
    probability: float

    def sentence(self) -> str:
        """What they may be, and what would tell."""
        return (
            f"{listed(self.ids)} may together be one cause that has no name (probability "
            f"{self.probability:.2f}): the gap goes about as well with {self.suspect}. Two loads "
            "of different size at every pose tell: what goes with the position is in proportion "
            "to the load."
        )


def imitated_together(fit: Fit, names: Sequence[Effect]) -> tuple[Imitated, ...]:
    """For every gear of which several laws were named: how probable one law of its position is.

    Beforehand as probable as these laws at once; the readings speak by their evidence (BIC), in
    which the number of waves is chosen among all that were tried.

    Args:
        fit: The fitted model, whose laws leave no more than noise.
        names: Effects that were added to it.
    """
    laws = Counter(name.where for name in names if name.of_gear)
    gears = [joint for joint, count in laws.items() if count > 1]
    if not gears:
        return ()
    line, everything = line_up_with(fit, names), range(len(names))
    whole = line.score(everything)
    out = []
    for joint in gears:
        own = [k for k, name in enumerate(names) if name.of_gear and name.where == joint]
        others = [k for k in everything if k not in own]
        evidence = {
            suspect.name: whole - line.score(others, k)
            for k, suspect in enumerate(line.suspects)
            if suspect.drive == joint
        }
        if not evidence:
            continue
        odds = float(np.exp(0.5 * np.minimum(list(evidence.values()), 100.0)).sum())
        best = max(evidence, key=lambda name: evidence[name])
        out.append(Imitated(tuple(names[k].id for k in own), best, odds / (1.0 + odds)))
    return tuple(out)
