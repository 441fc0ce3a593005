"""A name that is sure by the quick evidence is put before the full judgement of `explain`."""

from __future__ import annotations

from dataclasses import dataclass

from sk120stiff.errors import InputError, Refusal
from sk120stiff.explain import Options, explain
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model
from sk120stiff.pilot.campaign import Stop


@dataclass(frozen=True)
class Confirmation:
    """What the full judgement says of a stop.

    Attributes:
        agrees: It names the same, and nothing else, as sure as that no further reading tells it
            from another; or, of a class, one that holds it.
        verdict: Its verdict, or why it could not judge.
    """

    agrees: bool
    verdict: str


def confirmed(model: Model, readings: Measurements, stop: Stop) -> Confirmation:
    """Ask `explain` about a name, or a class of them."""
    try:
        answer = explain(model, readings, options=Options())
    except (InputError, Refusal) as error:
        return Confirmation(False, str(error))
    found = [{f.effect.id, *f.alternatives} for f in answer.findings]
    wanted = {name for each in stop.names for name in each.split(" with ")}
    every = all(group & wanted for group in found) and bool(found)
    if stop.reason == "named":
        every = every and all(any(name in group for group in found) for name in wanted)
        every = every and all(finding.settled for finding in answer.findings)
    return Confirmation(every, answer.verdict)
