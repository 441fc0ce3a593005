"""`<mimic>` rules: missing targets, no circles, and followers of joints that stand still."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

from sk120stiff.robot.urdf.document import JointSpec, Mimic, UrdfDocument
from sk120stiff.robot.urdf.findings import Notebook, at, did_you_mean, shown


def without_orphans(
    joints: tuple[JointSpec, ...], notes: Notebook
) -> tuple[tuple[JointSpec, ...], dict[str, Mimic]]:
    """The joints without mimic rules that name no joint of the robot, and those rules, each noted.

    Such a joint hinders nobody as long as it lies beside the arm; `refuse_orphans` asks of an arm.
    """
    names = {joint.name for joint in joints}
    orphans = {
        joint.name: joint.mimic
        for joint in joints
        if joint.mimic is not None and joint.mimic.joint not in names
    }
    for joint in joints:
        if joint.name in orphans:
            missing = orphans[joint.name].joint
            notes.warn(
                "mimic_unknown",
                at(joint.line, "joint", joint.name),
                f"the joint mimics {shown(missing)}, which does not exist, and is held still. "
                f"{did_you_mean(missing, names)}Mend its <mimic>, or write the rule under "
                "couplings in robot.yaml",
            )
    kept = (replace(j, mimic=None) if j.name in orphans else j for j in joints)
    return tuple(kept), orphans


def refuse_orphans(document: UrdfDocument, base: str, tool: str, settled: Collection[str]) -> None:
    """A joint of the arm whose mimic rule leads nowhere is not taken for a motor by guess.

    `settled` are joints of which the user said what they do.

    Raises:
        InputError: There is one between base and tool.
    """
    for joint in document.way(base, tool):
        rule = document.orphans.get(joint.name)
        if rule is None or joint.name in settled:
            continue
        Notebook(document.place).refuse(
            f"the joint mimics {shown(rule.joint)}, which does not exist; it lies between "
            f"{base!r} and {tool!r}",
            where=at(joint.line, "joint", joint.name),
            remedy=f"{did_you_mean(rule.joint, document.by_name)}Mend its <mimic>, or "
            f"say in robot.yaml what it does: couplings: {{{joint.name}: {{driver: JOINT}}}}, or "
            f"lock: {{{joint.name}: 0.0}}, or name it under actuated.",
        )


def checked_mimics(
    joints: tuple[JointSpec, ...], locked: dict[str, str], notes: Notebook
) -> tuple[JointSpec, ...]:
    """The joints, each mimic rule leading to a moving joint.

    A joint that follows one which does not move cannot move either: it becomes fixed at its offset.
    `locked` is extended by it. Chains of rules may come in any order.

    Raises:
        InputError: Rules run in a circle; the circle is listed.
    """
    by_name = {joint.name: joint for joint in joints}
    followers: dict[str, list[str]] = {}
    for joint in joints:
        if joint.mimic is not None:
            followers.setdefault(joint.mimic.joint, []).append(joint.name)
    for name in drivers_first(joints, by_name, notes):
        joint = by_name[name]
        if joint.mimic is None or by_name[joint.mimic.joint].moves:
            continue
        driver = joint.mimic.joint
        why = f"it mimics {shown(driver)}, which does not move"
        value = joint.mimic.offset  # a joint that does not move stands at zero
        origin = joint.standing(value)
        by_name[name] = replace(joint, type="fixed", origin=origin, mimic=None)
        for follower in followers.get(name, ()):  # they see its value through their own rule
            rule = by_name[follower].mimic
            if rule is not None:
                moved = rule._replace(offset=rule.offset + rule.multiplier * value)
                by_name[follower] = replace(by_name[follower], mimic=moved)
        locked[name] = why
        notes.warn(
            "joint_locked",
            at(joint.line, "joint", name),
            f"held still at {value:g} because {why}",
        )
    return tuple(by_name[joint.name] for joint in joints)


def drivers_first(
    joints: tuple[JointSpec, ...], by_name: Mapping[str, JointSpec], notes: Notebook
) -> list[str]:
    """Names of all joints, every driver before its followers."""
    done: dict[str, None] = {}
    for joint in joints:
        way: list[str] = []
        on_way: set[str] = set()
        name: str | None = joint.name
        while name is not None and name not in done:
            if name in on_way:
                circle = [*way[way.index(name) :], name]
                notes.refuse(
                    "mimic rules run in a circle: " + " → ".join(map(shown, circle)),
                    where=at(by_name[name].line, "joint", name),
                    remedy="Remove the <mimic> of one joint of the circle.",
                )
            way.append(name)
            on_way.add(name)
            rule = by_name[name].mimic
            name = rule.joint if rule is not None else None
        done.update(dict.fromkeys(reversed(way)))
    return list(done)
