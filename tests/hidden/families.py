"""Which names are one family: kinds of one law at one place, told apart only by its details."""

from __future__ import annotations

REVERSIBLE = frozenset({"gear_hardening", "lost_motion"})  # the joint's torque alone decides
HYSTERETIC = frozenset({"friction_hysteresis"})  # it matters where the torque came from
GEAR = REVERSIBLE | HYSTERETIC


def family(name: str) -> frozenset[str]:
    """All names that count as `name` where its law is right in kind alone."""
    for members in (REVERSIBLE, HYSTERETIC):
        if name in members:
            return members
    return frozenset({name})
