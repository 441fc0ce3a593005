"""Random causes of usual size, and the list of all causes that an arm could have."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .arm import Arm
from .causes_elastic import (
    BaseRocking,
    BaseSliding,
    ClosureCoupling,
    ClosureRod,
    JointTilt,
    LinkBending,
    LinkTorsion,
    ToolCompliance,
    WristSpring,
)
from .causes_foreign import (
    AxialLink,
    Hose,
    QuadraticMount,
    RadialBearing,
    RubberMount,
    ThermalLink,
    TrackerStand,
)
from .causes_joint import (
    Creep,
    FrictionHysteresis,
    GearHardening,
    GravityCompensator,
    LostMotion,
    Memory,
    PeriodicGear,
)
from .causes_sensor import (
    ForceBias,
    ForceCrosstalk,
    ForceRotation,
    ForceScale,
    JointOffset,
    LinkLength,
    ReadingDrift,
    ReadingRotation,
    ReadingScale,
    ToolOffset,
    ZeroOffset,
)
from .world import Cause

Rng = np.random.Generator


def around(rng: Rng, size: float, spread: float = 0.4) -> float:
    """Log-normal scatter around a usual size."""
    return float(size * np.exp(rng.normal(0.0, spread)))


@dataclass(frozen=True)
class Choice:
    """A cause that could be drawn, not yet with sizes."""

    name: str
    where: str
    make: Callable[[Rng], Cause]
    needs: tuple[str, ...] = ()  # schedules, or "positions", or "separate": any of them shows it


def choices(arm: Arm) -> list[Choice]:
    """Every catalogue cause with every place on this arm."""
    t = arm.typical
    out: list[Choice] = []

    def add(name: str, where: str, make: Callable[[Rng], Cause], *schedules: str) -> None:
        out.append(Choice(name, where, make, schedules))

    def pair(rng: Rng, size: float, keys: tuple[str, ...]) -> dict[str, float]:
        if rng.random() < 0.6:
            return dict.fromkeys(keys, around(rng, 1.0 / size))
        return {key: around(rng, 1.0 / size) for key in keys}

    for name, stiffness in t.wrist.items():
        add(
            "joint_springs",
            name,
            lambda r, n=name, k=stiffness: WristSpring(n, {"compliance": around(r, 1.0 / k)}),
        )
    heavy = list(arm.actuated)[:4] if len(arm.actuated) < 7 else list(arm.actuated)[:5]
    for name in heavy:
        add(
            "joint_tilt", name, lambda r, n=name: JointTilt(n, pair(r, t.tilt, ("first", "second")))
        )
    for link in arm.long_links():
        add(
            "link_bending",
            link,
            lambda r, n=link: LinkBending(
                n,
                {"flexibility": around(r, 1.0 / t.bending)},
                {"taper": float(r.uniform(0.1, 0.5)), "ratio": float(np.exp(r.normal(0, 0.05)))},
            ),
        )
        add(
            "link_torsion",
            link,
            lambda r, n=link: LinkTorsion(
                n,
                {"flexibility": around(r, 1.0 / t.torsion)},
                {"taper": float(r.uniform(0.1, 0.5))},
            ),
        )
    base = arm.base_link
    add("base_rocking", base, lambda r: BaseRocking(base, pair(r, t.rocking, ("x", "y"))))
    add("base_sliding", base, lambda r: BaseSliding(base, pair(r, t.sliding, ("x", "y", "z"))))
    tool = arm.tool_frame
    add(
        "tool_compliance",
        tool,
        lambda r: (
            ToolCompliance(tool, pair(r, t.tool, ("rx", "ry")))
            if r.random() < 0.6
            else ToolCompliance(tool, pair(r, t.tool_sliding, ("tx", "ty", "tz")))
        ),
    )
    if arm.loop is not None:
        first, second = arm.joints[arm.loop.pivot].name, arm.loop.driver
        cross = 1.0 / np.sqrt(t.joint[first] * t.joint[second])
        add(
            "closure_coupling",
            f"{first},{second}",
            lambda r: ClosureCoupling(
                f"{first},{second}", {"compliance": around(r, 0.05 * cross) * r.choice([-1, 1])}
            ),
        )
        lever = float(np.linalg.norm(arm.loop.lever))
        add(
            "closure_rod",
            "linkage",
            lambda r: ClosureRod(
                "linkage", {"compliance": around(r, 0.05 / t.joint[second] * lever**2)}
            ),
        )
        add(
            "gravity_compensator",
            first,
            lambda r: GravityCompensator(first, {"share": float(r.uniform(0.01, 0.05))}),
        )
    turning = [n for n in t.joint if not arm.slides(n)]
    largest = t.force * 1.5
    for name in turning[:3]:
        add(
            "gear_hardening",
            name,
            lambda r, n=name: (
                GearHardening(
                    n,
                    {"first": float(r.uniform(0.3, 0.8)), "second": float(r.uniform(0.05, 0.3))},
                    {
                        "T1": largest * float(r.uniform(0.1, 0.2)),
                        "T2": largest * float(r.uniform(0.35, 0.6)),
                    },
                )
                if r.random() < 0.5
                else GearHardening(n, {"cubic": float(r.uniform(0.3, 0.9))}, {"T": largest})
            ),
        )
        add(
            "lost_motion",
            name,
            lambda r, n=name: LostMotion(n, {"half_width": around(r, t.lost_motion, 0.3)}),
            "scattered",
            "up_down",
        )
        add(
            "friction_hysteresis",
            name,
            lambda r, n=name: FrictionHysteresis(n, {"half_width": around(r, t.friction, 0.3)}),
            "up_down",
        )

    def vector(r: Rng, size: float) -> dict[str, float]:
        return dict(zip("xyz", size * r.normal(size=3), strict=True))

    def crosstalk(r: Rng) -> ForceCrosstalk:
        keys = r.choice(["xy", "xz", "yx", "yz", "zx", "zy"], 2, replace=False)
        return ForceCrosstalk("sensor", {str(key): 0.015 * float(r.normal()) for key in keys})

    add("force_scale", "sensor", lambda r: ForceScale("sensor", vector(r, 0.02)))
    add("force_bias", "sensor", lambda r: ForceBias("sensor", vector(r, 0.01 * t.force)))
    add("force_rotation", "sensor", lambda r: ForceRotation("sensor", vector(r, 0.015)))
    add("force_crosstalk", "sensor", crosstalk)
    add("reading_rotation", "tracker", lambda r: ReadingRotation("tracker", vector(r, 0.004)))
    add("reading_scale", "tracker", lambda r: ReadingScale("tracker", {"share": 0.01 * r.normal()}))
    add("reading_drift", "tracker", lambda r: ReadingDrift("tracker", vector(r, 1e-6)), "positions")
    add(
        "zero_offset",
        "tracker",
        lambda r: ZeroOffset("tracker", {"rms": around(r, 2e-5)}, {"seed": int(r.integers(1e9))}),
        "separate",
    )
    for name in arm.actuated:
        add(
            "joint_offset",
            name,
            lambda r, n=name: JointOffset(n, {"offset": 0.003 * float(r.normal())}),
        )
    add("tool_offset", tool, lambda r: ToolOffset(tool, vector(r, 0.002)))
    for link in arm.long_links():
        add(
            "link_length",
            link,
            lambda r, n=link: LinkLength(n, {"length": 0.002 * float(r.normal())}),
        )
    return out


def foreign(arm: Arm) -> list[Choice]:
    """Causes outside every catalogue."""
    t = arm.typical
    turning = [n for n in t.joint if not arm.slides(n)]
    largest = t.force * 1.5
    base, tool = arm.base_link, arm.tool_frame
    links = arm.long_links()
    out = [
        Choice("foreign_quadratic_mount", base, lambda r: QuadraticMount(
            base, {key: around(r, 1.0 / t.rocking) for key in "xy"},
            {"full": largest, "gap": bool(r.random() < 0.5)})),
        Choice("foreign_rubber_mount", tool, lambda r: RubberMount(
            tool, {"compliance": around(r, 3.0 / t.tool_sliding)}, {"full": 0.3 * t.force})),
        Choice("foreign_hose", tool, lambda r: Hose(
            tool, {"stiffness": around(r, 0.02 * t.force / 1e-3),
                   "drag": around(r, 0.02 * t.force)})),
        Choice("foreign_tracker_stand", "tracker", lambda r: TrackerStand(
            "tracker", {"compliance": around(r, 0.5 / t.rocking)},
            {"at": (3.5 * float(r.choice([-1, 1])), float(r.normal()), -0.3)})),
    ]  # fmt: skip
    for name in turning[:3]:
        out += [
            Choice("foreign_periodic_gear", name, lambda r, n=name: PeriodicGear(
                n, {"share": float(r.uniform(0.05, 0.3))},
                {"count": int(r.integers(3, 12)), "phase": float(r.uniform(0, 6))})),
            Choice("foreign_memory", name, lambda r, n=name: Memory(
                n, {"share": float(r.uniform(0.1, 0.5))},
                {"play": largest * float(r.uniform(0.1, 0.3))}), ("up_down", "scattered")),
            Choice("foreign_creep", name, lambda r, n=name: Creep(
                n, {"share": float(r.uniform(0.02, 0.1))}, {"time": 3.0}),
                ("ascending", "up_down", "repeated")),
        ]  # fmt: skip
    for name in arm.actuated[:3]:
        out.append(Choice("foreign_radial_bearing", name, lambda r, n=name: RadialBearing(
            n, {"compliance": around(r, 1.0 / t.sliding)})))  # fmt: skip
    for link in links:
        out += [
            Choice("foreign_axial_link", link, lambda r, n=link: AxialLink(
                n, {"compliance": around(r, 1.0 / t.sliding)})),
            Choice("foreign_thermal_link", link, lambda r, n=link: ThermalLink(
                n, {"length": around(r, 2e-5)},
                {"period": float(r.uniform(40, 160)), "phase": float(r.uniform(0, 6))})),
        ]  # fmt: skip
    return out


def unit_causes(arm: Arm) -> list[Cause]:
    """All catalogue causes with all their parameters switched on, for comparing signatures."""
    rng = np.random.default_rng(0)
    t = arm.typical
    out: list[Cause] = []
    seen = set()
    for choice in choices(arm):
        if (choice.name, choice.where) in seen or choice.name == "zero_offset":
            continue
        seen.add((choice.name, choice.where))
        cause = choice.make(rng)
        if choice.name == "base_rocking":
            cause = BaseRocking(choice.where, dict.fromkeys("xyz", 1.0 / t.rocking))
        elif choice.name == "tool_compliance":
            sizes = dict.fromkeys(("rx", "ry", "rz"), 1.0 / t.tool)
            sizes.update(dict.fromkeys(("tx", "ty", "tz"), 1.0 / t.tool_sliding))
            cause = ToolCompliance(choice.where, sizes)
        elif choice.name == "force_crosstalk":
            keys = ("xy", "xz", "yx", "yz", "zx", "zy")
            cause = ForceCrosstalk("sensor", dict.fromkeys(keys, 0.01))
        elif choice.name == "gear_hardening":
            cause = GearHardening(choice.where, {"cubic": 0.5}, {"T": 1.5 * t.force})
        elif choice.name == "joint_tilt":
            cause = JointTilt(choice.where, dict.fromkeys(("first", "second"), 1.0 / t.tilt))
        elif choice.name == "link_bending":
            cause = LinkBending(choice.where, {"flexibility": 1.0 / t.bending}, {"pieces": 10})
        elif choice.name == "link_torsion":
            cause = LinkTorsion(choice.where, {"flexibility": 1.0 / t.torsion}, {"pieces": 2})
        out.append(cause)
    return out
