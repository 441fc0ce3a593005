"""Random causes that are right in kind and wrong in detail, of usual size."""

from __future__ import annotations

import numpy as np

from .arm import Arm
from .causes_curves import Dahl, MaxwellSlip, PowerHardening, SmoothPlay, SteppedHardening
from .causes_detail import RealBeam, TurnedRocking, WarmUp
from .draw import Choice, Rng, around
from .world import Cause


def real(arm: Arm) -> list[Choice]:
    """Every such cause with every place on this arm."""
    t = arm.typical
    largest = 1.5 * t.force
    turning = [name for name in t.joint if not arm.slides(name)][:3]
    out = []
    for name in turning:
        out += [
            Choice("lost_motion", name, lambda r, n=name: _play(r, n, t.lost_motion, largest),
                   ("scattered", "up_down")),
            Choice("gear_hardening", name, lambda r, n=name: _hardening(r, n, largest)),
            Choice("friction_hysteresis", name,
                   lambda r, n=name: _friction(r, n, t.friction, largest / t.joint[n]),
                   ("up_down",)),
        ]  # fmt: skip
    for link in arm.long_links():
        out.append(
            Choice("link_bending", link, lambda r, n=link: _beam(r, n, around(r, 1.0 / t.bending)))
        )
    base = arm.base_link
    out.append(Choice("base_rocking", base, lambda r: _rocking(r, base, t.rocking)))
    out.append(Choice("reading_drift", "tracker", _warm_up, ("positions",)))
    return out


def _play(rng: Rng, name: str, size: float, largest: float) -> Cause:
    skew = 0.0 if rng.random() < 0.4 else float(rng.uniform(-0.5, 0.5))
    flank = largest * float(np.exp(rng.uniform(np.log(0.01), np.log(0.15))))
    return SmoothPlay(name, {"half_width": around(rng, size, 0.3)}, {"flank": flank, "skew": skew})


def _hardening(rng: Rng, name: str, largest: float) -> Cause:
    if rng.random() < 0.5:
        exponent = float(rng.uniform(0.55, 0.8))
        share = float(rng.uniform(0.15, 0.5))
        return PowerHardening(name, {"share": share}, {"exponent": exponent, "full": largest})
    count = int(rng.integers(3, 6))
    knees = np.sort(largest * rng.uniform(0.05, 0.8, count))
    shares = np.sort(rng.uniform(0.05, 1.0, count))[::-1]
    return SteppedHardening(
        name, {"share": float(rng.uniform(0.4, 1.0))},
        {"knees": tuple(map(float, knees)), "shares": tuple(map(float, shares))},
    )  # fmt: skip


def _friction(rng: Rng, name: str, size: float, twist: float) -> Cause:
    """`twist`: that of the joint's spring at a large load."""
    sizes = {"half_width": around(rng, size, 0.3)}
    if rng.random() < 0.35:
        return Dahl(name, sizes, {"reach": twist * float(rng.uniform(0.03, 0.2))})
    count = int(rng.integers(3, 7))
    shares = rng.dirichlet(np.full(count, 2.0))
    reach = np.sort(twist * np.exp(rng.uniform(np.log(0.02), np.log(0.4), count)))
    return MaxwellSlip(
        name, sizes, {"shares": tuple(map(float, shares)), "reach": tuple(map(float, reach))}
    )


def _beam(rng: Rng, link: str, flexibility: float) -> Cause:
    steps: tuple[tuple[float, float], ...] = ()
    if rng.random() < 0.5:
        steps = (
            (float(rng.uniform(0.2, 0.8)), float(np.exp(rng.uniform(np.log(0.3), np.log(4))))),
        )
    options = {
        "taper": float(rng.uniform(0.0 if steps else 0.4, 0.75)), "steps": steps,
        "ratio": float(np.exp(rng.normal(0.0, 0.3))), "tube": bool(rng.random() < 0.7),
    }  # fmt: skip
    return RealBeam(link, {"flexibility": flexibility}, options)


def _rocking(rng: Rng, base: str, stiffness: float) -> Cause:
    soft = around(rng, 1.5 / stiffness)
    sizes = {"soft": soft, "stiff": soft / float(rng.uniform(2.0, 6.0))}
    return TurnedRocking(base, sizes, {"turn": float(rng.uniform(0.0, np.pi))})


def _warm_up(rng: Rng) -> Cause:
    rate = 3e-6 * rng.normal(size=3)
    sizes = dict(zip("xyz", map(float, rate), strict=True))
    return WarmUp("tracker", sizes, {"time": float(rng.uniform(15.0, 50.0))})
