"""From any form of a URDF to a checked `UrdfDocument`: the order of the steps."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from lxml.etree import _Element as Element

from sk120stiff.errors import InputError, MissingPart
from sk120stiff.robot.urdf.clean import clean_xml
from sk120stiff.robot.urdf.dh_table import is_dh_table, urdf_of_table
from sk120stiff.robot.urdf.document import JointSpec, UrdfDocument, VisualSpec
from sk120stiff.robot.urdf.findings import Notebook, at
from sk120stiff.robot.urdf.joints import read_joint, same_names
from sk120stiff.robot.urdf.links import read_link, read_materials, read_shapes
from sk120stiff.robot.urdf.mimics import checked_mimics, without_orphans
from sk120stiff.robot.urdf.packages import package_folders
from sk120stiff.robot.urdf.source import RawSource, read_source
from sk120stiff.robot.urdf.structure import declared_links, find_root
from sk120stiff.robot.urdf.xacro import (
    expand,
    is_xacro,
    refuse_empty,
    refuse_text,
    with_environment,
)
from sk120stiff.robot.urdf.xml_tree import decode, parse_robot

_FOREIGN = frozenset(
    {
        "transmission", "gazebo", "ros2_control", "sensor", "mujoco", "plugin", "static", "author",
        "plugins", "gripper", "actuator", "contact", "group", "project", "include", "visual",
        "kinematics", "safety_controller", "inertial", "collision", "verbose", "version", "isaac",
        "self_collide", "disable_collisions", "keep", "fixed_camera", "sk120stiff",
    }
)  # fmt: skip


def read_urdf(
    source: str | os.PathLike[str] | bytes,
    *,
    xacro_arguments: Mapping[str, str] | None = None,
) -> UrdfDocument:
    """Read a robot description in any form, repair what can be repaired, and say so.

    Args:
        source: ``.urdf`` or ``.xacro`` file, folder that holds exactly one, XML as text or bytes,
            or a ``.csv`` table of Denavit and Hartenberg's numbers (`dh_table.py`).
        xacro_arguments: Values of ``<xacro:arg>``; one that the xacro does not know is refused.

    Returns:
        UrdfDocument: One tree of links, with a finding for every repair.

    Raises:
        InputError: The description cannot be used; the message names the line and the remedy.
    """
    raw = read_source(source)
    notes = Notebook(raw.label)
    folders = package_folders(raw.path)
    text = decode(raw.data, notes)
    if raw.path is not None and is_dh_table(raw.path):
        text = urdf_of_table(text, raw.path.stem, raw.label)
    arguments = dict(xacro_arguments or {})
    if not is_xacro(raw, text):
        if arguments:
            notes.refuse(
                f"this is no xacro and takes no arguments ({', '.join(arguments)})",
                remedy="Leave the arguments out, or give the .xacro file.",
            )
        return _plain(raw, text, folders, notes)
    if raw.is_xacro or arguments:
        return _expanded(raw, text, folders, arguments, notes)
    try:
        return _expanded(raw, text, folders, arguments, notes)
    except MissingPart:
        raise
    except InputError as refusal:  # a URDF that somebody expanded by hand
        notes = Notebook(raw.label)
        notes.warn("xacro_skipped", "", f"xacro elements were ignored: {refusal.what}")
        try:
            return _document(text, raw, folders, notes)
        except InputError:
            raise refusal from None


def document_tree(document: UrdfDocument) -> Element:
    """`<robot>` with everything that stands in the user's file, comments too, to be edited."""
    return parse_robot(document.text, Notebook(document.place), comments=True)


def _plain(raw: RawSource, text: str, folders: tuple[Path, ...], notes: Notebook) -> UrdfDocument:
    """A file without xacro; `$(optenv ...)`, which some generators leave behind, gets its value."""
    filled = with_environment(text)
    if filled != text:
        notes.warn("environment_value", "", "$(env ...) was replaced by values of the environment")
    try:
        return _document(filled, raw, folders, notes)
    except InputError:
        if raw.path is None:  # what xacro elements are left over in a readable text are ignored
            refuse_text(text, notes)
        raise


def _expanded(
    raw: RawSource,
    text: str,
    folders: tuple[Path, ...],
    arguments: Mapping[str, str],
    notes: Notebook,
) -> UrdfDocument:
    expanded = expand(raw, text, folders, arguments, notes)
    notes.source = f"{raw.label} (expanded)"
    if parse_robot(expanded, Notebook(notes.source)).find("link") is None:
        refuse_empty(raw, text, notes)
    return _document(expanded, raw, folders, notes)


def _document(
    text: str, raw: RawSource, folders: tuple[Path, ...], notes: Notebook
) -> UrdfDocument:
    root = parse_robot(text, notes)
    name = _robot_name(root, raw, notes)
    _note_foreign(root, notes)
    link_elements = root.findall("link")
    declared = [read_link(element, notes) for element in link_elements]
    same_names([(link.name, link.line) for link in declared], "link", notes)
    joints: list[JointSpec] = []
    locked: dict[str, str] = {}
    for element in root.iterchildren("joint"):
        joint, why = read_joint(element, notes)
        joints.append(joint)
        if why is not None:
            locked[joint.name] = why
    same_names([(joint.name, joint.line) for joint in joints], "joint", notes)
    _refuse_reserved(joints, notes)
    links = declared_links(declared, joints, notes) if declared else tuple(declared)
    tree_root = find_root(links, joints, notes, root.sourceline)
    coupled, orphans = without_orphans(tuple(joints), notes)
    checked = checked_mimics(coupled, locked, notes)
    colours = read_materials(root, notes)
    visuals: list[VisualSpec] = []
    collisions: list[VisualSpec] = []
    for element, link in zip(link_elements, declared, strict=True):
        visuals.extend(read_shapes(element, link.name, colours, notes))
        collisions.extend(read_shapes(element, link.name, colours, notes, "collision"))
    return UrdfDocument(
        name=name,
        xml=clean_xml(name, links, checked),
        text=text,
        path=raw.path,
        package_folders=folders,
        joints=checked,
        links=links,
        visuals=tuple(visuals),
        collisions=tuple(collisions),
        root=tree_root,
        locked=locked,
        orphans=orphans,
        warnings=tuple(notes.findings),
    )


def _robot_name(root: Element, raw: RawSource, notes: Notebook) -> str:
    name = (root.get("name") or "").strip()
    if name:
        return name
    name = raw.path.name.split(".")[0] if raw.path is not None else ""
    name = name or "robot"
    notes.warn("robot_name_missing", at(root.sourceline), f"<robot> has no name; called {name!r}")
    return name


def _note_foreign(root: Element, notes: Notebook) -> None:
    seen: set[str] = set()
    for child in root:
        tag = child.tag
        if tag in ("link", "joint", "material") or tag in _FOREIGN or "{" in tag or tag in seen:
            continue
        seen.add(tag)
        notes.warn(
            "unknown_element", at(child.sourceline), f"<{tag[:40]}> is not URDF and was ignored"
        )


def _refuse_reserved(joints: list[JointSpec], notes: Notebook) -> None:
    for joint in joints:
        if joint.name == "universe":
            notes.refuse(
                "the joint name 'universe' is reserved for the ground",
                where=at(joint.line, "joint", joint.name),
                remedy="Rename the joint.",
            )
