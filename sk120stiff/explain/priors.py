"""How often an effect is met on an arm that disagrees with its model, before anything is measured.

A model's score pays −2 ln(odds) for every effect; the table says where an effect is met more or
less often than `USUAL`. No survey of causes is known to the authors: an entry is a judgement, with
its reason, and ``--prior base_rocking=0.5`` puts your own knowledge of an arm in its place. That
so many effects at so many places are looked at is paid for besides (`--alpha`).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from sk120stiff.effects import CATALOGUE, Effect
from sk120stiff.errors import InputError

USUAL = 0.1  # of every effect without an entry
FAR_SOFTER = 0.01  # of a foundation or tool far softer than is customary: on wheels, on rubber
SOMETHING_ELSE = 0.1  # that a cause is at work which the catalogue lacks
# Of a name beside such a cause: that it imitates a part of it all the same (`judge/imitation.py`).
# The strongest name seldom does, a further one takes what that leaves. On draws of the hidden
# benchmark with which the judgement was made, before the last of its rules, 2 of 39 strongest names
# and 7 of 17 further ones did: the numbers are a judgement between these and what the rules mend.
IMPOSTOR, FURTHER_IMPOSTOR = 0.04, 0.25
# Of what its evidence alone would say of a name that fell in the judgement: that it is at work all
# the same, as other poses, resampling or a better place speak against it.
FALLEN = 0.2


@dataclass(frozen=True)
class Prior:
    """Probability that an effect is at work at one of its places, and why."""

    probability: float
    source: str


PRIORS: Mapping[str, Prior] = {
    "joint_tilt": Prior(
        0.063, "Bearings are made stiff against tilting; floors and anchors are often not."
    ),
}


def price(effect: Effect, given: Mapping[str, float]) -> float:
    """What an effect adds to a model's score for being less usual than `USUAL`; negative if more.

    Args:
        effect: The effect.
        given: Probabilities that the user gave, by ``name`` or ``name:where``.
    """
    table = PRIORS[effect.name].probability if effect.name in PRIORS else USUAL
    return 2.0 * (_logit(USUAL) - _logit(given.get(effect.id, given.get(effect.name, table))))


def priors_from(texts: Iterable[str]) -> dict[str, float]:
    """Probabilities from texts such as ``base_rocking=0.5`` or ``joint_tilt:joint_2=0.3``.

    Raises:
        InputError: No such effect, or no probability between 0 and 1.
    """
    found: dict[str, float] = {}
    for text in texts:
        name, _, number = text.partition("=")
        kind = name.partition(":")[0]
        if kind not in CATALOGUE:
            raise CATALOGUE.unknown(kind)
        try:
            value = float(number)
        except ValueError:
            value = np.nan
        if not 0.0 < value < 1.0:
            raise InputError(
                f"{number!r} is no probability between 0 and 1",
                where=f"--prior {text}",
                remedy=f"Write --prior {name}=0.5; --exclude {name} leaves it out altogether.",
            )
        found[name] = value
    return found


def _logit(probability: float) -> float:
    return float(np.log(probability / (1.0 - probability)))
