"""What gears do beyond a linear spring: they harden, they have lost motion, they rub.

A gear has one curve of twist against torque. Its reversible part is told by hardening and lost
motion, which know enough shapes between them for any curve that flattens; the part that remembers
where the torque came from is told by friction. Which shape an effect takes is a law of it
(`Effect.other_laws`); the joint and the kind of curve are what a name says.
"""

from sk120stiff.effects.gear.friction import FrictionHysteresis
from sk120stiff.effects.gear.hardening import GearHardening
from sk120stiff.effects.gear.lost_motion import LostMotion

__all__ = ["FrictionHysteresis", "GearHardening", "LostMotion"]
