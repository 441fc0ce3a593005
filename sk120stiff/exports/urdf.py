"""A calibrated URDF: the user's own file with the joints where they truly stand.

Only the origins of joints change that the model's geometry moves, and masses where the model's are
others; meshes, limits, comments and foreign elements stay. What a URDF has no word for stands in an
element ``<sk120stiff>`` that other readers pass over (docs/FILES.md).
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from lxml import etree
from lxml.etree import _Element as Element

from sk120stiff.arrays import Array
from sk120stiff.effects import Elastic
from sk120stiff.exports.contract import Exported, Format, Request, Told
from sk120stiff.exports.geometry import IN_MASSES, MEASURED, Geometry, geometry_of, weighing
from sk120stiff.model import Model
from sk120stiff.robot import Robot, find_robot
from sk120stiff.robot.rotations import rotation_vector, rpy_from_rotation
from sk120stiff.robot.urdf import Mimic, document_tree, resolve
from sk120stiff.robot.urdf.clean import numbers

EXTENSION = "sk120stiff"
VERSION = "1"  # of the extension


def make(model: Model, request: Request) -> Exported:
    """See `Format.make`."""
    robot, geometry = model.robot, geometry_of(model)
    root = document_tree(robot.document)
    joints = {element.get("name", "").strip(): element for element in root.iterchildren("joint")}
    corrections = dict(geometry.corrections)
    left_out = list(geometry.left_out)
    if not np.array_equal(geometry.tool, np.eye(4)):
        last = robot.document.way(robot.base_frame, robot.tool_frame)[-1]
        if last.moves:
            left_out.append(Told("tool frame", f"{last.child} moves itself: no origin before it"))
        else:
            corrections[last.name] = geometry.tool
    for name, correction in corrections.items():
        _set_origin(joints[name], robot.document.by_name[name].origin @ correction)
    coupled = _add_couplings(robot, joints)
    if geometry.measured.any():
        _add_measured(root, robot, geometry)
    heavier = weighing(model, IN_MASSES)
    if heavier:
        _weigh(root, model.assembly.heavier(model.values))
    carried = (*geometry.carried, *heavier)
    elastic = [e for e in model.physical().effects if isinstance(e, Elastic) and _acts(model, e)]
    left_out += [Told(e.id, f"in <{EXTENSION}>, which other readers pass over") for e in elastic]
    _add_extension(root, model, {told.effect: told.how for told in carried})
    meshes = _moved_meshes(root, robot, request.out)
    tree = root.getroottree()
    text = etree.tostring(tree, encoding="utf-8", xml_declaration=True).decode("utf-8") + "\n"
    head, robot_tag, body = text.partition("<robot")  # lxml puts what stands before it in one line
    text = head.replace("-->", "-->\n") + robot_tag + body
    return Exported(
        text,
        carried,
        tuple(left_out),
        notes=_notes(robot, coupled, meshes),
        details={
            "origins": [
                {"joint": name, "shift_m": D[:3, 3], "turn_rad": rotation_vector(D[:3, :3])}
                for name, D in corrections.items()
            ],
            "meshes_missing": meshes,
        },
        title="Origins that changed",
        header=("joint", "shift [mm]", "turn [mrad]"),
        rows=[
            (name, 1e3 * np.linalg.norm(D[:3, 3]), 1e3 * np.linalg.norm(rotation_vector(D[:3, :3])))
            for name, D in corrections.items()
        ],
    )


FORMAT = Format("urdf", "calibrated URDF", (".urdf",), make)


def _acts(model: Model, effect: Elastic) -> bool:
    return any(p.internal != 0.0 for p in model.parameters if p.effect is effect)


def _set_origin(joint: Element, placement: Array) -> None:
    origin = joint.find("origin")
    if origin is None:
        origin = etree.Element("origin")
        origin.tail = joint.text
        joint.insert(0, origin)
    origin.set("xyz", numbers(placement[:3, 3]))
    origin.set("rpy", numbers(rpy_from_rotation(placement[:3, :3])))
    for other in set(origin.attrib) - {"xyz", "rpy"}:  # a turn stated in some other way
        del origin.attrib[other]


def _add_couplings(robot: Robot, joints: dict[str, Element]) -> tuple[str, ...]:
    """Write rules of `robot.yaml` into the file; names of the joints that got one."""
    told = []
    for name, rule in robot.followers.items():
        if robot.document.by_name[name].mimic == Mimic(rule.driver, rule.multiplier, rule.offset):
            continue
        for old in joints[name].findall("mimic"):
            joints[name].remove(old)
        mimic = etree.SubElement(joints[name], "mimic", joint=rule.driver)
        mimic.set("multiplier", repr(rule.multiplier))
        mimic.set("offset", repr(rule.offset))
        told.append(name)
    return tuple(told)


def _add_measured(root: Element, robot: Robot, geometry: Geometry) -> None:
    frame = f"{robot.tool_frame}{MEASURED}"
    for old in root.xpath("link[@name=$n] | joint[@name=$j]", n=frame, j=f"{frame}_joint"):
        root.remove(old)
    joint = etree.SubElement(root, "joint", name=f"{frame}_joint", type="fixed")
    etree.SubElement(joint, "origin", xyz=numbers(geometry.measured), rpy="0 0 0")
    etree.SubElement(joint, "parent", link=robot.tool_frame)
    etree.SubElement(joint, "child", link=frame)
    link = etree.SubElement(root, "link", name=frame)
    joint.tail = link.tail = "\n"


def _weigh(root: Element, heavier: float) -> None:
    """Make every link heavier by one factor; inertias go with the mass."""
    for element in root.xpath("link/inertial/mass | link/inertial/inertia"):
        for name, value in element.attrib.items():
            element.set(name, repr(heavier * float(value)))


def _add_extension(root: Element, model: Model, carried: dict[str, str]) -> None:
    """Every effect with its values and where they come from, beside what the file itself holds."""
    for old in root.findall(EXTENSION):
        root.remove(old)
    extension = etree.SubElement(root, EXTENSION, version=VERSION)
    if model.provenance:
        etree.SubElement(extension, "source", dict(model.provenance))
    for effect in model.effects:
        place = {None: "here", IN_MASSES: "masses"}.get(carried.get(effect.id), "origins")
        told = {"name": effect.name, "where": effect.where, "carried": place}
        element = etree.SubElement(extension, "effect", told)
        for parameter in (p for p in model.parameters if p.effect is effect):
            said = {"name": parameter.spec.name, "value": repr(parameter.value)}
            if parameter.std is not None:
                said["std"] = repr(parameter.std)
            said["unit"] = parameter.spec.unit
            if parameter.origin:
                said["origin"] = parameter.origin
            etree.SubElement(element, "parameter", said)
    etree.indent(extension, space="  ", level=1)
    extension.tail = "\n"
    before = extension.getprevious()
    if before is not None and not (before.tail or "").strip():
        before.tail = "\n  "


def _moved_meshes(root: Element, robot: Robot, out: Path) -> list[str]:
    """Point relative addresses to the files that they meant; addresses that lead nowhere."""
    document, missing = robot.document, []
    for mesh in root.iter("mesh"):
        address = (mesh.get("filename") or "").strip()
        path, _ = resolve(address, document.path, document.package_folders)
        if path is None:
            missing.append(address)
        elif "://" not in address and not os.path.isabs(address):
            there = os.path.relpath(path, out.absolute().parent)
            mesh.set("filename", Path(there).as_posix())
    return list(dict.fromkeys(missing))


def _notes(robot: Robot, coupled: tuple[str, ...], missing: list[str]) -> tuple[str, ...]:
    notes = []
    if coupled:
        notes.append(f"Couplings of robot.yaml are written as <mimic>: {', '.join(coupled)}.")
    if robot.closures:
        notes.append("A URDF has no closed loops: keep the closures of robot.yaml beside it.")
    if missing:
        notes.append(f"Meshes that are not there are named as before: {', '.join(missing)}.")
    repaired = [str(f) for f in robot.document.warnings if f.code == "xacro_expanded"]
    if repaired:
        notes.append("The xacro is written out as a plain URDF.")
    if find_robot(robot.source).folder is not None:
        notes.append("What robot.yaml says still holds: name this file under urdf in a copy of it.")
    notes.append(
        "Do not put this model on the exported robot again: its geometry would count twice."
    )
    return tuple(notes)
