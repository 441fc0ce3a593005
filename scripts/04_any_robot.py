"""Any arm from its URDF: a UR10 and a Franka Panda get springs, and are loaded at the tool.

    python scripts/04_any_robot.py                    both, from the package example-robot-data
    python scripts/04_any_robot.py my_robot.urdf      your own arm: .urdf, .xacro, or a folder

The two public robots come with `pip install "sk120stiff[corpus]"`. Their springs are plausible
guesses, the same for every joint of one kind: harmonic drives of light arms have some 1e4 N·m/rad.
Put in your own; `sk120stiff identify` finds them from measured deflections.
"""

from __future__ import annotations

import sys
from importlib import metadata
from pathlib import Path

import numpy as np

from sk120stiff import joint_spring_model, load_robot, loaded_stiffness
from sk120stiff.robot.checks import check_robot

# Springs [N·m/rad] and a pose [deg] for the public ones.
PUBLIC = {
    "ur10_robot.urdf": ([5e4, 5e4, 3e4, 1e4, 1e4, 1e4], [20, -70, 90, -110, -90, 10]),
    "panda.urdf": ([1.4e4] * 4 + [9e3] * 3, [0, -45, 0, -135, 0, 90, 45]),
}
SLIDING, TURNING = 1e6, 2e4  # for your own robot: N/m where a joint slides, N·m/rad else
LOAD = np.array([0.0, 0.0, -50.0, 0.0, 0.0, 0.0])  # N and N·m, axes of the base frame


def main() -> None:
    """Check, load, give springs, load at a pose, print."""
    given = sys.argv[1:]
    files = metadata.distribution("example-robot-data").files or [] if not given else []
    sources = given or [
        str(file.locate()) for name in PUBLIC for file in files if file.name == name
    ]
    for source in sources:
        report = check_robot(source)
        print(f"\n{report.name}: {len(report.actuated)} joints, {report.total_mass_kg:.1f} kg")
        for reason in report.chosen_because:
            print(f"  {reason}")
        for finding in report.warnings:
            print(f"  suspicious: {finding}")

        robot = load_robot(source)
        springs, degrees = PUBLIC.get(Path(source).name, (None, None))
        if springs is None:
            springs = [SLIDING if slides else TURNING for slides in robot.prismatic]
        if degrees is not None:
            pose = np.radians(degrees)
        else:  # away from most singular poses: a third of the way through the limits
            lower, upper = np.maximum(robot.lower, -3.0), np.minimum(robot.upper, 3.0)
            pose = lower + (upper - lower) / 3.0

        loaded = loaded_stiffness(joint_spring_model(robot, springs), pose, LOAD)
        print("  pose", dict(zip(robot.actuated, np.round(pose, 3).tolist(), strict=True)))
        print("  tool at", np.round(robot.placement(pose)[:3, 3], 4), "m, load", LOAD[:3], "N")
        print("  principal stiffness", np.round(loaded.principal.values / 1e3, 1), "N/mm")
        print("  deflection without K_C  ", micrometres(loaded.deflection_conventional))
        print("  deflection with K_C     ", micrometres(loaded.deflection_enhanced))
        print("  at exact equilibrium    ", micrometres(loaded.deflection_equilibrium))
        print(f"  unstable at {loaded.critical_factor:.0f} times this load")


def micrometres(displacement: np.ndarray) -> str:
    """A displacement [m] as text."""
    return f"{np.round(1e6 * displacement, 1)} µm"


if __name__ == "__main__":
    main()
