"""`<link>` elements: masses and pictures."""

from __future__ import annotations

import numpy as np
from lxml.etree import _Element as Element

from sk120stiff.errors import InputError
from sk120stiff.robot.urdf.document import GeometrySpec, Inertial, LinkSpec, VisualSpec
from sk120stiff.robot.urdf.fields import Fields
from sk120stiff.robot.urdf.findings import Notebook, at, shown

Colour = tuple[float, float, float, float]
LONGEST_NAME = 500
_MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def read_name(element: Element, notes: Notebook) -> str:
    """Name of a link or joint, blanks around it removed.

    Raises:
        InputError: It has none.
    """
    raw = element.get("name")
    name = (raw or "").strip()
    if not name:
        notes.refuse(
            f"this {element.tag} has no name",
            where=at(element.sourceline),
            remedy=f'Give it one: <{element.tag} name="...">.',
        )
    if len(name) > LONGEST_NAME:
        notes.refuse(
            f"this name has {len(name)} characters; at most {LONGEST_NAME} can be handled",
            where=at(element.sourceline, element.tag, name),
            remedy="Shorten it.",
        )
    if name != raw:
        where = at(element.sourceline, element.tag, name)
        notes.warn("name_blanks", where, "blanks around the name removed")
    return name


def read_link(element: Element, notes: Notebook) -> LinkSpec:
    """One link with its inertial.

    Raises:
        InputError: No name, or something in the inertial is no number.
    """
    name = read_name(element, notes)
    return LinkSpec(name, _inertial(element, Fields(notes, "link", name)), element.sourceline)


def _inertial(link: Element, fields: Fields) -> Inertial | None:
    element = link.find("inertial")
    if element is None:
        return None
    if len(link.findall("inertial")) > 1:
        fields.warn("duplicate_element", element, "several <inertial>; the first one was used")
    mass_element = element.find("mass")
    mass = fields.number(mass_element, "value") if mass_element is not None else None
    if mass is None:
        fields.warn("mass_missing", element, "<inertial> without a mass; taken as massless")
        mass = 0.0
    inertia = np.zeros((3, 3))
    inertia_element = element.find("inertia")
    if inertia_element is None:
        if mass != 0.0:
            note = "<inertial> without <inertia>; taken as a point mass"
            fields.warn("inertia_missing", element, note)
    else:
        values = {key: fields.number(inertia_element, key) for key in _MOMENTS}
        absent = [key for key, value in values.items() if value is None]
        if absent:
            note = f"{', '.join(absent)} missing; taken as 0"
            fields.warn("inertia_missing", inertia_element, note)
        xx, xy, xz, yy, yz, zz = (values[key] or 0.0 for key in _MOMENTS)
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return Inertial(mass, fields.placement(element), inertia)


def read_materials(robot: Element, notes: Notebook) -> dict[str, Colour]:
    """Colours of all named materials: those of the robot, then those defined inside visuals.

    The first definition of a name holds.
    """
    colours: dict[str, Colour] = {}
    top = robot.findall("material")
    for number, element in enumerate([*top, *robot.findall("link/visual/material")]):
        name = (element.get("name") or "").strip()
        colour = element.find("color")
        if not name or colour is None:
            continue
        where = at(element.sourceline, "material", name)
        if name in colours:
            if number < len(top):
                notes.warn("duplicate_material", where, "defined twice; the first one was used")
            continue
        try:
            rgba = _rgba(colour, Fields(notes, "material", name))
        except InputError as error:
            notes.warn("unknown_material", where, f"its colour was ignored: {error.what}")
            continue
        if rgba is not None:
            colours[name] = rgba
    return colours


def _rgba(colour: Element, fields: Fields) -> Colour | None:
    count = len((colour.get("rgba") or "").replace(",", " ").split())
    values = fields.vector(colour, "rgba", 3 if count == 3 else 4)
    if values is None:
        return None
    r, g, b, *rest = (min(max(float(v), 0.0), 1.0) for v in values)
    return (r, g, b, rest[0] if rest else 1.0)


def read_shapes(
    link: Element, name: str, colours: dict[str, Colour], notes: Notebook, tag: str = "visual"
) -> list[VisualSpec]:
    """Shapes of one link, to be seen or (`tag` ``collision``) not to be run into.

    A shape that cannot be understood is noted and left out.
    """
    found = []
    for element in link.iterchildren(tag):
        fields = Fields(notes, "link", name)
        try:
            shape = _visual(element, fields, colours)
        except InputError as error:  # a picture never stops the kinematics
            fields.warn("visual_unreadable", element, f"a shape was left out: {error.what}")
            continue
        if shape is not None:
            found.append(shape)
    return found


def _visual(element: Element, fields: Fields, colours: dict[str, Colour]) -> VisualSpec | None:
    geometry_element = element.find("geometry")
    if geometry_element is None:
        fields.warn("unknown_geometry", element, f"<{element.tag}> without <geometry> was left out")
        return None
    geometry = _geometry(geometry_element, fields)
    if geometry is None:
        return None
    rgba = None
    material = element.find("material")
    if material is not None:
        colour = material.find("color")
        key = (material.get("name") or "").strip()
        rgba = _rgba(colour, fields) if colour is not None else colours.get(key)
        if colour is None and key and key not in colours and material.find("texture") is None:
            fields.warn("unknown_material", material, f"material {shown(key)} is not defined")
    label = (element.get("name") or "").strip()
    return VisualSpec(
        fields.name, label, fields.placement(element), geometry, rgba, element.sourceline
    )


def _geometry(element: Element, fields: Fields) -> GeometrySpec | None:
    for shape in element:
        if shape.tag == "mesh":
            filename = (shape.get("filename") or "").strip()
            if not filename:
                fields.warn("mesh_missing", shape, "<mesh> without a filename was left out")
                return None
            scale = _scale(shape, fields)
            return GeometrySpec("mesh", scale, filename)
        if shape.tag in _SIZES:
            sizes = _sizes(shape, fields)
            if sizes is None:
                note = f"<{shape.tag}> without its size was left out"
                fields.warn("unknown_geometry", shape, note)
                return None
            if min(sizes) <= 0.0:
                fields.warn("unknown_geometry", shape, f"<{shape.tag}> of size ≤ 0 was left out")
                return None
            return GeometrySpec(shape.tag, sizes)
        note = f"geometry <{shape.tag[:40]}> is unknown and was left out"
        fields.warn("unknown_geometry", shape, note)
        return None
    fields.warn("unknown_geometry", element, "<geometry> without a shape was left out")
    return None


_SIZES: dict[str, tuple[str, ...]] = {
    "box": (),
    "sphere": ("radius",),
    "cylinder": ("radius", "length"),
    "capsule": ("radius", "length"),
}


def _sizes(shape: Element, fields: Fields) -> tuple[float, ...] | None:
    if shape.tag == "box":
        size = fields.vector(shape, "size")
        return None if size is None else tuple(map(float, size))
    values = [fields.number(shape, key) for key in _SIZES[shape.tag]]
    return None if None in values else tuple(v for v in values if v is not None)


def _scale(mesh: Element, fields: Fields) -> tuple[float, ...]:
    text = mesh.get("scale") or ""
    if len(text.replace(",", " ").split()) == 1:
        factor = fields.number(mesh, "scale")
        return (factor or 1.0,) * 3
    scale = fields.vector(mesh, "scale")
    return (1.0, 1.0, 1.0) if scale is None else tuple(map(float, scale))
