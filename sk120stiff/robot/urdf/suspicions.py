"""What is odd about a readable URDF: masses, inertias, limits, couplings, names, sizes, meshes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sk120stiff.files import note_read
from sk120stiff.robot.urdf.document import Finding, Inertial, JointSpec, UrdfDocument
from sk120stiff.robot.urdf.findings import at, listed, shown
from sk120stiff.robot.urdf.packages import resolve

_LARGEST_ARM = 50.0  # m
_LARGEST_OFFSET = 20.0  # m between two joints
_HEAVIEST_LINK = 20_000.0  # kg
_TWO_TURNS = 4.0 * np.pi
_PLACEHOLDER = 1e3  # limits beyond it mean "none"


def suspicions(document: UrdfDocument) -> tuple[Finding, ...]:
    """Findings of a document beyond the repairs made while it was read; never raises."""
    with np.errstate(all="ignore"):
        return tuple(
            finding
            for check in (_masses, _limits, _couplings, _names, _sizes, _meshes)
            for finding in check(document)
        )


def _masses(document: UrdfDocument) -> Iterator[Finding]:
    if document.total_mass <= 0.0:
        yield Finding(
            "no_mass",
            document.place,
            "no link has a mass: gravity effects are impossible, gravity torques are all zero",
        )
        return
    zero = [link for link in document.links if link.inertial is not None and link.mass == 0.0]
    if zero:
        others = f": {listed([link.name for link in zero])}" if len(zero) > 1 else ""
        where = at(zero[0].line, "link", zero[0].name)
        yield Finding("mass_zero", where, f"a mass of zero is stated{others}")
    for link in document.links:
        where = at(link.line, "link", link.name)
        if link.inertial is None:
            continue
        if link.mass < 0.0:
            yield Finding("mass_negative", where, f"mass {link.mass:g} kg is negative")
        elif link.mass > _HEAVIEST_LINK:
            yield Finding("units", where, f"mass {link.mass:g} kg: is it given in grams?")
        yield from _inertia(link.inertial, where)
    yield from _weightless(document)


def _weightless(document: UrdfDocument) -> Iterator[Finding]:
    """Moving joints that carry a body without mass although the robot has masses elsewhere."""
    heavy: set[str] = set()
    for link in document.links:
        name = link.name
        while link.mass > 0.0 and name in document.above:
            joint = document.above[name]
            if joint.moves:
                heavy.add(joint.name)
                break
            name = joint.parent
    light = [joint.name for joint in document.moving_joints if joint.name not in heavy]
    if light:
        yield Finding(
            "mass_incomplete",
            document.place,
            f"{len(light)} of {len(document.moving_joints)} moving joints carry a body without "
            f"mass: {listed(light, 5)}; gravity torques lack it",
        )


def _inertia(inertial: Inertial, where: str) -> Iterator[Finding]:
    if not inertial.inertia.any():
        return
    with np.errstate(all="ignore"):
        moments = np.linalg.eigvalsh(inertial.inertia)
    if not np.isfinite(moments).all():
        yield Finding("inertia_not_definite", where, "the inertia overflows")
        return
    tolerance = 1e-9 * float(np.max(np.abs(moments)))
    if moments[0] <= -tolerance or moments[2] <= 0.0:
        text = ", ".join(f"{value:.3g}" for value in moments)
        yield Finding(
            "inertia_not_definite",
            where,
            f"the inertia is not positive definite (principal moments {text} kg·m²)",
        )
    elif moments[0] <= 0.0:
        yield Finding("inertia_singular", where, "a principal moment of inertia is zero")
    elif moments[0] + moments[1] < moments[2] * (1.0 - 1e-6):
        text = " + ".join(f"{value:.3g}" for value in moments[:2])
        yield Finding(
            "inertia_triangle",
            where,
            f"no body has this inertia: {text} < {moments[2]:.3g} kg·m² (triangle inequality)",
        )


def _limits(document: UrdfDocument) -> Iterator[Finding]:
    moving = document.moving_joints
    for key in ("effort", "velocity"):
        idle = [joint for joint in moving if getattr(joint, key) == 0.0]
        yield from _together(f"{key}_zero", idle, f"{key} limit is 0, probably not known")
    for joint in moving:
        widest = max(abs(joint.lower or 0.0), abs(joint.upper or 0.0))
        if joint.type == "revolute" and _TWO_TURNS < widest <= _PLACEHOLDER:
            yield Finding(
                "units",
                at(joint.line, "joint", joint.name),
                f"a limit of {widest:g} rad exceeds two turns: is it given in degrees?",
            )
    outside = [
        joint
        for joint in moving
        if (joint.lower is not None and joint.lower > 0.0)
        or (joint.upper is not None and joint.upper < 0.0)
    ]
    yield from _together("zero_outside_limits", outside, "zero lies outside the limits")


def _together(code: str, joints: list[JointSpec], message: str) -> Iterator[Finding]:
    """One finding for one oddity of many joints, placed at the first of them."""
    if joints:
        first = joints[0]
        names = [joint.name for joint in joints]
        others = f": {listed(names)}" if len(names) > 1 else ""
        yield Finding(code, at(first.line, "joint", first.name), message + others)


def _couplings(document: UrdfDocument) -> Iterator[Finding]:
    for joint in document.moving_joints:
        if joint.mimic is None:
            continue
        where = at(joint.line, "joint", joint.name)
        driver = document.by_name[joint.mimic.joint]
        rule = f"{joint.mimic.multiplier:g} · {driver.name} + {joint.mimic.offset:g}"
        yield Finding("mimic", where, f"coupled joint: {joint.name} = {rule}")
        if joint.mimic.multiplier == 0.0:
            yield Finding("mimic_zero", where, f"multiplier 0: it stands at {joint.mimic.offset:g}")
        if (joint.type == "prismatic") != (driver.type == "prismatic"):
            yield Finding(
                "mimic_units",
                where,
                f"a {joint.type} joint follows a {driver.type} one: check the multiplier's unit",
            )


def _names(document: UrdfDocument) -> Iterator[Finding]:
    for link in document.links:
        clash = document.by_name.get(link.name)
        if clash is not None:
            yield Finding(
                "name_clash",
                at(link.line, "link", link.name),
                f"a joint has the same name (line {clash.line}); frames here are links",
            )
    if any(link.name == "universe" for link in document.links):
        yield Finding("name_clash", "link 'universe'", "Pinocchio calls the ground by this name")


def _sizes(document: UrdfDocument) -> Iterator[Finding]:
    reach = 0.0
    for joint in document.joints:
        length = float(np.linalg.norm(joint.origin[:3, 3]))
        reach = max(reach, length)
        if length > _LARGEST_OFFSET:
            yield Finding(
                "units",
                at(joint.line, "joint", joint.name),
                f"its origin lies {length:g} m from its parent: are these millimetres?",
            )
    extent = _extent(document)
    if extent > _LARGEST_ARM:
        message = f"the robot reaches {extent:g} m from its root: are lengths in millimetres?"
        yield Finding("units", document.place, message)
    elif document.moving_joints and reach > 0.0 and extent < 5e-3:
        yield Finding("units", document.place, f"the robot reaches only {extent:g} m from its root")


def _extent(document: UrdfDocument) -> float:
    """Longest distance along the tree from the root to a link, joints at zero [m]."""
    distance, links = {document.root: 0.0}, [document.root]
    for link in links:
        for joint in document.below.get(link, ()):
            offset = float(np.linalg.norm(joint.origin[:3, 3]))
            distance[joint.child] = distance[link] + offset
            links.append(joint.child)
    return max(distance.values())


def _meshes(document: UrdfDocument) -> Iterator[Finding]:
    known: dict[str, str] = {}
    missing: dict[str, list[str]] = {}
    for visual in document.visuals:
        address = visual.geometry.filename
        if address is None:
            continue
        if address not in known:
            file, why = resolve(address, document.path, document.package_folders)
            known[address] = "" if file is not None else why
            if file is not None:
                note_read(file)
        if known[address]:
            missing.setdefault(known[address], []).append(address)
    for why, addresses in missing.items():
        unique = list(dict.fromkeys(addresses))
        count = f"{len(unique)} meshes" if len(unique) > 1 else "a mesh"
        yield Finding(
            "mesh_missing", document.place, f"{count} not found, {why}: {listed(unique, 3)}"
        )


def locked_on_way(document: UrdfDocument, base: str, tool: str) -> tuple[Finding, ...]:
    """Joints between two frames that the file describes as moving but that are held still."""
    return tuple(
        Finding(
            "locked_on_chain",
            at(joint.line, "joint", joint.name),
            f"lies between {shown(base)} and {shown(tool)} and is held still because "
            f"{document.locked[joint.name]}",
        )
        for joint in document.way(base, tool)
        if joint.name in document.locked
    )
