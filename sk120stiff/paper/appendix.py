"""Appendix I: the paper's Jacobian, coded from its text, against ours.

How its angles (primed) follow from the readings of the bundled robot, whose joint 2 is measured
from the vertical and whose joint 3 is the forearm's absolute elevation, positive up::

    θ1' = θ1,  θ2' = θ2 + 90°,  θ3' = −θ3,  θ4' = θ4,  θ5' = θ5,  θ6' = θ6

so that the third column of the paper's Jacobian is minus ours. The fixture adds to D6 along the
tool's axis and is L6 across it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.paper.printed import DIMENSIONS, FIXTURE
from sk120stiff.paper.setting import Setting, random_poses, slopes, straight

#: Every length that Appendix I names.
LENGTHS = ("L1", "L2", "L3", "L4", "L5", "L6", "D1", "D3", "D4", "D5", "D6")


@cache
def printed_terms() -> dict[str, str]:
    """Element of eq. (17) → its terms as printed."""
    text = (files("sk120stiff.paper") / "appendix_1.txt").read_text(encoding="utf-8")
    elements = text.replace("\n    ", " ").splitlines()[1:]
    return {line[:3]: line[4:] for line in elements}


def printed_jacobian(angles: Array, lengths: Mapping[str, float]) -> Array:
    """(..., 3, 3) derivatives of x, y, z by θ1', θ2', θ3' by eq. (17) as printed [m/rad].

    Args:
        angles: (..., 6) the paper's angles θ1' to θ6' [rad].
        lengths: Any of `LENGTHS` [m]; the others are zero.
    """
    given = np.asarray(angles, dtype=float)
    named = {str(k + 1): given[..., k] for k in range(6)} | {"23": given[..., 1] - given[..., 2]}
    factors = {f"s{k}": np.sin(angle) for k, angle in named.items()}
    factors |= {f"c{k}": np.cos(angle) for k, angle in named.items()}
    J = np.zeros((*given.shape[:-1], 3, 3))
    for element, text in printed_terms().items():
        for term in text.replace("- ", "+ -").split("+ "):
            length, *angular = term.removeprefix("-").split() or [""]
            if length in lengths:
                value = -lengths[length] if term.startswith("-") else lengths[length]
                value = value * np.prod([factors[name] for name in angular], axis=0)
                J[..., int(element[1]) - 1, int(element[2]) - 1] += value
    return J


def mended_jacobian(angles: Array, lengths: Mapping[str, float]) -> Array:
    """Eq. (17) with + D4 cos θ1 cos θ3 and − D3 sin θ1 in J21."""
    J, (t1, _, t3) = printed_jacobian(angles, lengths), np.moveaxis(angles[..., :3], -1, 0)
    D4, D1, D3 = (lengths.get(name, 0.0) for name in ("D4", "D1", "D3"))
    J[..., 1, 0] += 2.0 * D4 * np.cos(t1) * np.cos(t3) + (D1 - D3) * np.sin(t1)
    return J


def paper_angles(readings: Array) -> Array:
    """(..., 6) angles of Appendix I for joint readings (..., 6) [rad]."""
    angles = np.array(readings, dtype=float)
    angles[..., 1] += np.pi / 2
    angles[..., 2] *= -1.0
    return angles


@dataclass(frozen=True)
class Slip:
    """A term of eq. (17) that contradicts the others, off by `size` times its length."""

    element: str
    length: str
    size: float


@dataclass(frozen=True, eq=False)
class Appendix:
    """Appendix I against the bundled robot.

    `slips` are found without our kinematics; the errors are (3, 3) largest differences to our
    Jacobian over random poses of all six joints, at the reflector [m/rad].
    """

    slips: tuple[Slip, ...]
    printed_error: Array
    mended_error: Array


def appendix(setting: Setting, *, seed: int = 0) -> Appendix:
    """Compare eq. (17) with our Jacobian at the reflector, and with itself."""
    rng = np.random.default_rng(seed)
    readings = np.concatenate(
        [random_poses(rng, 200), rng.uniform(-np.pi, np.pi, (200, 3))], axis=1
    )
    ours = setting.arm(readings, "reflector").linear_jacobian * np.array([1.0, 1.0, -1.0])
    lengths = {**DIMENSIONS, "D6": DIMENSIONS["D6"] + FIXTURE[0], "L6": FIXTURE[1]}
    angles = paper_angles(readings)
    return Appendix(
        slips=slips(),
        printed_error=np.max(np.abs(printed_jacobian(angles, lengths) - ours), axis=0),
        mended_error=np.max(np.abs(mended_jacobian(angles, lengths) - ours), axis=0),
    )


def slips(*, seed: int = 1) -> tuple[Slip, ...]:
    """Terms of eq. (17) that cannot belong to one arm which turns about a vertical axis.

    J11 = −y and J21 = x, and a quarter turn of joint 1 carries x to y: so J21(θ1) must be
    −J11(θ1 + 90°), length by length. Where they differ, the one whose slope by θ3 is not −J23 or
    J13 is wrong.
    """
    angles = np.random.default_rng(seed).uniform(-np.pi, np.pi, (50, 6))

    def slip_of(length: str) -> Slip:
        def J(turn: Array) -> Array:
            return printed_jacobian(angles + straight(turn), {length: 1.0})

        here, turned = J(np.zeros(3)), J(np.array([np.pi / 2, 0.0, 0.0]))
        slope = slopes(lambda turn: J(turn)[:, :2, 0], 1e-3)[..., 2]
        off = np.max(np.abs(slope - here[:, [1, 0], 2] * [-1.0, 1.0]), axis=0)
        apart = np.max(np.abs(here[:, 1, 0] + turned[:, 0, 0]))
        return Slip("J11" if off[0] > off[1] else "J21", length, float(apart))

    return tuple(slip for slip in map(slip_of, LENGTHS) if slip.size > 1e-12)
