"""L5 exact aliases, L7 causes outside the catalogue, L8 and L9 messy noise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .case import Case, Hidden
from .causes_elastic import (
    BaseRocking,
    BaseSliding,
    JointTilt,
    LinkBending,
    LinkTorsion,
    WristSpring,
)
from .causes_joint import FrictionHysteresis, LostMotion
from .causes_sensor import ForceScale, ReadingScale
from .draw import choices, foreign, unit_causes
from .levels import (
    NotThisTime,
    Rng,
    Setting,
    hide,
    pick,
    setting,
    shows,
    together,
    unseen_arm,
)
from .noise import Noise
from .robots import six_axis
from .signature import blocks, rivals, signature, tuned, view
from .sk120 import sk120
from .world import Cause


def alias(level: str, seed: tuple[int, ...], rng: Rng) -> Case:
    """L5: a cause that no reading of positions can tell from its twin."""
    kind = str(
        rng.choice(
            ["forearm_twist", "arm_twist", "play", "foundation", "slide_drift", "absorbed"],
            p=[0.2, 0.25, 0.2, 0.15, 0.1, 0.1],
        )
    )
    if kind == "absorbed":
        return _absorbed(level, seed, rng)
    at, cause, accepted = _alias_of(kind, level, seed, rng)
    seen = view(at.world, at.train, at.noise)
    cause = tuned(seen, cause, float(np.exp(rng.uniform(np.log(15.0), np.log(50.0)))), widest=10.0)
    if cause is None:
        raise NotThisTime(kind)
    hidden = hide(at, cause, seen, blocks(seen, unit_causes(at.arm)))
    return at.case([cause], hidden=[hidden], accepted=accepted, expected="ambiguous", note=kind)


def _alias_of(
    kind: str, level: str, seed: tuple[int, ...], rng: Rng
) -> tuple[Setting, Cause, list[str]]:
    arm = sk120()
    if kind == "forearm_twist":
        # the forearm's tube lies around the axis of joint 4: its torsion is that joint's spring
        at = setting(level, seed, rng, arm=arm)
        twins = ["joint_springs:joint_4_r", "link_torsion:link_3_u"]
        return at, WristSpring("joint_4_r", {"compliance": 1 / 3e5}), twins
    if kind == "arm_twist":
        if rng.random() < 0.5:
            arm = six_axis()
        joint, link = ("lift", "upper_arm") if arm.name == "six_axis" else ("joint_2_l", "link_2_l")
        at = setting(level, seed, rng, arm=arm)
        twins = [f"joint_tilt:{joint}", f"link_torsion:{link}"]
        if rng.random() < 0.5:
            return at, JointTilt(joint, {"first": 1.0 / arm.typical.tilt}), twins
        shaft = {"flexibility": 1.0 / arm.typical.torsion}
        return at, LinkTorsion(link, shaft, {"taper": float(rng.uniform(0.1, 0.5))}), twins
    if kind == "play":
        name = str(rng.choice(["joint_1_s", "joint_2_l", "joint_3_u"]))
        at = setting(level, seed, rng, arm=arm, schedule="ascending")
        twins = [f"lost_motion:{name}", f"friction_hysteresis:{name}"]
        make = LostMotion if rng.random() < 0.5 else FrictionHysteresis
        return at, make(name, {"half_width": 1e-4}), twins
    if kind == "foundation":
        at = setting(level, seed, rng, arm=arm)
        twins = ["base_rocking:base_link", "joint_tilt:joint_1_s"]
        size = 1.0 / arm.typical.rocking
        if rng.random() < 0.5:
            return at, BaseRocking("base_link", {"x": size, "y": size}), twins
        return at, JointTilt("joint_1_s", {"first": size, "second": size}), twins
    at = setting(level, seed, rng, arm=arm, schedule="one_direction", positions=True)
    twins = ["base_sliding:base_link", "reading_drift:tracker"]
    return at, BaseSliding("base_link", dict.fromkeys("xyz", 1.0 / arm.typical.sliding)), twins


def _absorbed(level: str, seed: tuple[int, ...], rng: Rng) -> Case:
    """A cause that the springs of the base model take over entirely: nothing is left to name."""
    at = setting(level, seed, rng, arm=sk120())
    soft = 1.0 / at.arm.typical.rocking
    cause: Cause = [
        BaseRocking("base_link", {"z": soft}),
        ForceScale("sensor", dict.fromkeys("xyz", 0.03)),
        ReadingScale("tracker", {"share": 0.008}),
        LinkBending("link_2_l", {"flexibility": 1.0 / at.arm.typical.bending},
                    {"only": 1, "taper": 0.3}),
    ][int(rng.integers(4))]  # fmt: skip
    u = float(np.linalg.norm(signature(view(at.world, at.train, at.noise), cause)))
    if u > 1.0:
        raise NotThisTime(f"{cause.name} stays visible ({u:.1f})")
    return at.case([cause], hidden=[Hidden(cause, u, u)], expected="none", note="absorbed")


def outside(level: str, seed: tuple[int, ...], rng: Rng) -> Case:
    """L7: foreign to the catalogue, or of a class that the command line takes out of it."""
    at = setting(level, seed, rng)
    removed = bool(rng.random() < 0.4)
    pool = choices(at.arm) if removed else foreign(at.arm)
    chosen = pick([c for c in pool if shows(c, at)], rng)
    seen = view(at.world, at.train, at.noise)
    target = float(np.exp(rng.uniform(np.log(25.0), np.log(70.0))))
    cause = tuned(seen, chosen.make(rng), target, widest=10.0)
    if cause is None:
        raise NotThisTime(chosen.name)
    table = blocks(seen, unit_causes(at.arm))
    u = signature(seen, cause)
    left = [r for r in rivals(u, ("", ""), table) if not removed or r.name != cause.name]
    if left[0].separation < 6.0:
        raise NotThisTime(f"{cause.name} looks like {left[0].name}")
    norm = float(np.linalg.norm(u))
    return at.case(
        [cause],
        hidden=[Hidden(cause, norm, left[0].separation, left)],
        expected="outside",
        arguments=["--exclude", cause.name] if removed else [],
        note="removed" if removed else "foreign",
    )


MESSES = ("shared_unknown", "growing", "growing_columns", "outliers", "distance", "understated")


def messy(kind: str, rng: Rng) -> tuple[Noise, bool, str | None]:
    """Noise, whether the zero is shared, and the schedule that it needs."""
    sigma = float(np.exp(rng.uniform(np.log(4e-6), np.log(15e-6))))
    plain = Noise(sigma)
    if kind == "shared_unknown":
        return replace(plain, declared={"zero": "unknown"}), True, None
    if kind == "growing":
        return replace(plain, growth=float(rng.uniform(0.01, 0.04))), True, "repeated"
    if kind == "growing_columns":
        grown = replace(plain, growth=float(rng.uniform(0.01, 0.04)), declared={"columns": True})
        return grown, False, None
    if kind == "outliers":
        share = float(rng.uniform(0.01, 0.04))
        size = sigma * float(rng.uniform(10.0, 60.0))
        return replace(plain, outliers=share, outlier_size=size), bool(rng.random() < 0.5), None
    if kind == "distance":
        far = replace(plain, angular=float(rng.uniform(1e-6, 4e-6)), along=0.5)
        return replace(far, declared={"columns": True}), False, None
    if kind == "understated":
        # nobody states a sigma; repeats tell it
        return replace(plain, declared={"noise": None}), True, "repeated"
    raise ValueError(kind)


def clean_messy(level: str, seed: tuple[int, ...], rng: Rng) -> Case:
    """L8: nothing hidden, but the noise is not what a simple mind expects."""
    kind = str(rng.choice(MESSES[:4], p=[0.3, 0.2, 0.2, 0.3]))
    if rng.random() < 0.2:
        kind = str(rng.choice(MESSES[4:]))
    noise, shared, schedule = messy(kind, rng)
    positions = None if kind != "shared_unknown" else False
    at = setting(
        level, seed, rng, noise=noise, shared=shared, schedule=schedule, positions=positions
    )
    return at.case([], expected="none", note=kind)


def wild(level: str, seed: tuple[int, ...], rng: Rng) -> Case:
    """L9: an unknown robot from its URDF, several causes, messy noise, loads over a pulley."""
    arm, urdf = unseen_arm(rng)
    kind = str(rng.choice(MESSES))
    noise, shared, schedule = messy(kind, rng)
    if rng.random() < 0.3:
        noise = replace(noise, wander=0.1 * noise.sigma)
    at = setting(
        level, seed, rng, arm=arm, urdf=urdf, noise=noise, shared=shared, schedule=schedule,
        positions=False,
    )  # fmt: skip
    if rng.random() < 0.4:
        at = replace(at, world=replace(at.world, pulley=float(rng.uniform(1.5, 4.0))))
    count = int(rng.integers(2, 4))
    causes, entries = together(at, rng, count, low=10.0, high=60.0, least=5.0, apart=0.0)
    return at.case(causes, hidden=entries, note=kind, truth_extra={"count": count})
