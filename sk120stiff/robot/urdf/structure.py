"""Joints and links as one tree: undeclared links, roots, loops, depth; all without recursion."""

from __future__ import annotations

from collections.abc import Sequence

from sk120stiff.robot.urdf.document import JointSpec, LinkSpec
from sk120stiff.robot.urdf.findings import Notebook, at, close_name, listed, shown

# Pinocchio's URDF parser calls itself once per level and uses about 2.3 kB of stack for it:
# 8 MB end near level 3500, 1 MB near level 450. Real arms have fewer than 50 levels.
MAX_DEPTH = 300

_CLOSURE = """cut it there: make {joint} fixed, give it a new empty child link \
{child}_closure, and declare in robot.yaml that both links meet:
closures:
  - {{frames: [{child}_closure, {child}], {pin}}}"""


def declared_links(
    links: Sequence[LinkSpec], joints: Sequence[JointSpec], notes: Notebook
) -> tuple[LinkSpec, ...]:
    """All links, those included that only a joint mentions, such as `world`; each is noted."""
    known = {link.name for link in links}
    added: dict[str, LinkSpec] = {}
    for joint in joints:
        for tag, name in (("parent", joint.parent), ("child", joint.child)):
            if name in known or name in added:
                continue
            close = close_name(name, known) if len(added) < 5 else None
            hint = f"; did you mean {close!r}?" if close else ""
            notes.warn(
                "link_undeclared",
                at(joint.line, "joint", joint.name),
                f"its {tag} link {shown(name)} is not declared; added without mass{hint}",
            )
            added[name] = LinkSpec(name, None, 0)
    return (*links, *added.values())


def find_root(
    links: Sequence[LinkSpec], joints: Sequence[JointSpec], notes: Notebook, line: int = 0
) -> str:
    """The one link from which every other is reached.

    Raises:
        InputError: No link, several roots, a loop, or a tree deeper than `MAX_DEPTH`.
    """
    if not links:
        notes.refuse(
            "the robot has no links",
            where=at(line),
            remedy='Add at least one <link name="..."/>, and joints between links.',
        )
    parent_joint: dict[str, JointSpec] = {}
    for joint in joints:
        if joint.parent == joint.child:
            notes.refuse(
                f"the joint joins link {shown(joint.parent)} to itself",
                where=at(joint.line, "joint", joint.name),
                remedy="Name two different links as <parent> and <child>.",
            )
        if joint.child in parent_joint:
            _refuse_two_parents(parent_joint, parent_joint[joint.child], joint, notes)
        parent_joint[joint.child] = joint
    roots = [link for link in links if link.name not in parent_joint]
    depth: dict[str, int] = {root.name: 0 for root in roots}
    for link in links:
        _climb(link.name, parent_joint, depth, notes)
    if len(roots) > 1:
        lines = ", ".join(
            f"{shown(root.name)}" + (f" (line {root.line})" if root.line else "")
            for root in roots[:8]
        )
        notes.refuse(
            f"{len(roots)} links have no parent: {lines}; a robot has one root",
            where=at(roots[1].line, "link", roots[1].name),
            remedy="Join them with a fixed joint, mend the name in a <parent> or <child>, "
            "or delete the loose link.",
        )
    deepest = max(depth.values())
    if deepest > MAX_DEPTH:
        notes.refuse(
            f"{deepest} joints lie one behind the other; at most {MAX_DEPTH} can be handled",
            where=at(0, "link", max(depth, key=lambda name: depth[name])),
            remedy="Merge links that are joined by fixed joints.",
        )
    return roots[0].name


def _climb(
    name: str, parent_joint: dict[str, JointSpec], depth: dict[str, int], notes: Notebook
) -> None:
    """Fill in `depth` from a link up to the first link whose depth is known."""
    way: list[str] = []
    on_way: set[str] = set()
    while name not in depth:
        if name in on_way:
            loop = [parent_joint[link] for link in way[way.index(name) :]]
            _refuse_loop(loop[::-1], loop[0], notes)
        way.append(name)
        on_way.add(name)
        name = parent_joint[name].parent
    level = depth[name]
    for link in reversed(way):
        level += 1
        depth[link] = level


def _refuse_two_parents(
    parent_joint: dict[str, JointSpec], first: JointSpec, second: JointSpec, notes: Notebook
) -> None:
    """Two joints carry one link: a closed loop if both ways lead back to one link."""
    left, right = _ancestry(first, parent_joint), _ancestry(second, parent_joint)
    on_left = {joint.parent: k for k, joint in enumerate(left)}
    for k, joint in enumerate(right):
        if joint.parent in on_left:
            loop = [*left[: on_left[joint.parent] + 1], *right[k::-1]]
            _refuse_loop(loop, second, notes)
        if joint.parent == second.child:
            _refuse_loop(right[: k + 1][::-1], second, notes)
    notes.refuse(
        f"link {shown(second.child)} is the child of two joints, {shown(first.name)} "
        f"(line {first.line}) and {shown(second.name)}",
        where=at(second.line, "joint", second.name),
        remedy="A link has one parent: delete one joint, or mend its <child>.",
    )


def _ancestry(joint: JointSpec, parent_joint: dict[str, JointSpec]) -> list[JointSpec]:
    """The joint and those above it, up to a root or until they repeat."""
    way, seen = [joint], {joint.child, joint.parent}
    while (above := parent_joint.get(way[-1].parent)) is not None:
        way.append(above)
        if above.parent in seen:
            break
        seen.add(above.parent)
    return way


def _refuse_loop(loop: list[JointSpec], closing: JointSpec, notes: Notebook) -> None:
    names = [joint.name for joint in loop]
    pin = "type: point"
    if closing.type in ("revolute", "continuous"):
        pin = "type: axis, axis: [" + ", ".join(f"{x:g}" for x in closing.axis) + "]"
    notes.refuse(
        f"the joints {listed(names, 12)} form a closed loop; a URDF holds trees only",
        where=at(closing.line, "joint", closing.name),
        remedy="Delete that joint, or, if the mechanism is really closed, "
        + _CLOSURE.format(joint=closing.name, child=closing.child, pin=pin),
    )
