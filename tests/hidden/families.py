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


# Causes whose law no catalogue has, but whose kind and place it does: what a user is told by the
# name is true, and what it leaves over is a remainder. The others have no name at all.
KINDS = {
    "foreign_memory": "friction_hysteresis",  # a gear that lags, across the whole series
    "foreign_quadratic_mount": "base_rocking",  # the floor yields, with the square of the moment
    "foreign_rubber_mount": "tool_compliance",  # the mount of the tool yields, and stiffens
}


def kind(name: str) -> str | None:
    """The catalogue's name for the kind of a foreign cause; None where there is none."""
    return KINDS.get(name)
