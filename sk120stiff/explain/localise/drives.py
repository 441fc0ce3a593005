"""What a gap may go with in the drives: torques, laws that are no straight line, angles, creep."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from sk120stiff.effects import LoadCases
from sk120stiff.explain.localise.suspect import Suspect
from sk120stiff.model import Model

CREEPS = (1.0, 10.0, 100.0)  # readings that creep takes, one term of a series a decade
MOST_WAVES = 40  # of a drive's softness in a turn: the teeth of an output stage


def drives(load_cases: LoadCases) -> Iterator[Suspect]:
    """Drives that yield in proportion to their torque; those with a spring are the model's own."""
    J = load_cases.nominal.linear_jacobian
    load = load_cases.nominal.at(load_cases.force_point).torques(load_cases.wrench)
    for i, joint in enumerate(load_cases.robot.actuated):
        what, unit = _effort(load_cases, i)
        columns = (J[:, :, i] * load[:, i, None])[..., None]
        label = f"{what} of {joint} [{unit}]"
        yield Suspect("place", f"the {what} of {joint}", columns, load[:, i], label)


def laws(load_cases: LoadCases) -> Iterator[Suspect]:
    """A drive whose law is not a straight line, or two drives that a linkage ties together."""
    J = load_cases.nominal.linear_jacobian  # (N, 3, n)
    at_force = load_cases.nominal.at(load_cases.force_point)
    torque = at_force.torques(load_cases.wrench) + load_cases.gravity_torque
    load = at_force.torques(load_cases.wrench)
    both = len(np.unique(load_cases.branch)) > 1
    names = load_cases.robot.actuated
    for i, joint in enumerate(names):
        tau, push = torque[:, i], J[:, :, i]
        what, unit = _effort(load_cases, i)
        label = f"{what} of {joint} [{unit}]"
        largest = float(np.abs(tau).max(initial=0.0)) or 1.0
        size = np.linalg.norm(push, axis=1, keepdims=True)
        along = push / np.where(size > 0.0, size, 1.0)
        sign = np.sign(tau) - np.sign(load_cases.gravity_torque[:, i])
        jump = f"the sign of the {what} of {joint}"
        bent = (f"gear_hardening:{joint}", f"lost_motion:{joint}")
        columns = (push * sign[:, None])[..., None]
        yield Suspect("law", jump, columns, tau, label, along, frees=bent)
        curved = tau[:, None] * np.stack([np.abs(tau) / largest, (tau / largest) ** 2], axis=-1)
        name = f"the {what} of {joint}, not in proportion to it"
        columns = push[:, :, None] * curved[:, None, :]
        yield Suspect("law", name, columns, tau, label, along, frees=bent)
        if both:
            turn = -load_cases.branch * np.sign(load[:, i])
            name = f"loading or unloading of {joint}"
            columns = (push * turn[:, None])[..., None]
            rubs = (f"friction_hysteresis:{joint}",)
            yield Suspect("law", name, columns, load[:, i], label, along, frees=rubs)
        if load_cases.order is not None and np.ptp(load_cases.order) > 0.0:
            since = np.maximum(load_cases.order, 0.0)[:, None]  # a zero may have been read after
            lasting = 1.0 - np.exp(-since / np.array(CREEPS))
            columns = (push * load[:, i, None])[:, :, None] * lasting[:, None, :]
            name = f"the {what} of {joint} as it lasts, in creep"
            yield Suspect("law", name, columns, load_cases.order, "readings since the zero", along)
    for i, k in combinations(range(len(names)), 2):
        column = J[:, :, i] * load[:, k, None] + J[:, :, k] * load[:, i, None]
        name = f"the torques of {names[i]} and {names[k]}, each moving the other joint"
        what, unit = _effort(load_cases, i)
        label = f"{what} of {names[i]} [{unit}]"
        yield Suspect("linkage", name, column[..., None], load[:, i], label)


def angles(model: Model, load_cases: LoadCases) -> Iterator[Suspect]:
    """Drives whose stiffness changes with the angle of a joint."""
    J = load_cases.nominal.linear_jacobian
    load = load_cases.nominal.at(load_cases.force_point).torques(load_cases.wrench)
    soft = np.flatnonzero(np.isfinite(model.joint_stiffness()))
    yielding = J[:, :, soft] * load[:, None, soft]  # (N, 3, s)
    for i, joint in enumerate(load_cases.robot.actuated):
        q = load_cases.a[:, i]
        if np.ptp(q) < 1e-6:
            continue
        if load_cases.robot.prismatic[i]:
            factors, shown, unit = [q / np.ptp(q)], 1e3 * q, "mm"
        else:
            factors, shown, unit = [np.cos(q), np.sin(q)], np.degrees(q), "deg"
        columns = np.concatenate([yielding * f[:, None, None] for f in factors], axis=-1)
        name = f"the position of {joint}, on which a drive's stiffness may depend"
        yield Suspect("angle", name, columns, shown, f"position of {joint} [{unit}]")


def waves(load_cases: LoadCases) -> Iterator[Suspect]:
    """Drives that are softer at some of their teeth: the same after every whole part of a turn.

    Poses cannot tell more waves over the range that they span than half their number.
    """
    J = load_cases.nominal.linear_jacobian
    load = load_cases.nominal.at(load_cases.force_point).torques(load_cases.wrench)
    poses = len(np.unique(load_cases.pose))
    for i, joint in enumerate(load_cases.robot.actuated):
        q = load_cases.a[:, i]
        if load_cases.robot.prismatic[i] or np.ptp(q) < 1e-6:
            continue
        yielding = (J[:, :, i] * load[:, i, None])[:, :, None]
        most = min(int(np.pi * poses / np.ptp(q)), MOST_WAVES)
        for count in range(1, most + 1):
            wave = np.stack([np.cos(count * q), np.sin(count * q)], axis=-1)
            turns = f"{count} wave{'s' if count > 1 else ''} a turn"
            name = f"the position of {joint}, on which its own stiffness depends in {turns}"
            label = f"position of {joint} [deg]"
            columns = yielding * wave[:, None, :]
            yield Suspect("angle", name, columns, np.degrees(q), label, drive=joint, alike=most)


def _effort(load_cases: LoadCases, joint: int) -> tuple[str, str]:
    return ("force", "N") if load_cases.robot.prismatic[joint] else ("torque", "N·m")
