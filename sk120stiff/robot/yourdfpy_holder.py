"""A robot as yourdfpy's `URDF`, which viser, pyroki and trimesh's viewers take.

yourdfpy is the holder here and not the reader: it accepts files whose joints form no tree or whose
numbers are none, follows textures and stops at the first broken mesh. So it is given what was
checked and repaired before, and only those shapes that can be read.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.errors import require
from sk120stiff.robot.robot import Robot
from sk120stiff.robot.urdf import resolve
from sk120stiff.robot.urdf.document import JointSpec, LinkSpec, UrdfDocument, VisualSpec
from sk120stiff.robot.visuals import visuals

if TYPE_CHECKING:
    import yourdfpy


def as_yourdfpy(robot: Robot, a: ArrayLike | None = None, *, meshes: bool = False) -> yourdfpy.URDF:
    """The robot in yourdfpy's own classes, its joints at `a`.

    Args:
        robot: A loaded robot, repairs applied.
        a: (n,) actuated coordinates [rad or m]; zero unless given. Coupled joints and closed loops
            follow: those that no `<mimic>` rules are set to where they stand at `a`.
        meshes: Load the meshes too, into `URDF.scene`; one that cannot be read is left out.

    Raises:
        InputError: `a` has another number of coordinates.
        MissingPart: yourdfpy is not installed.

    Examples:
        >>> import sk120stiff as sk
        >>> from sk120stiff.robot import as_yourdfpy
        >>> robot = sk.load_robot("motoman_sk120")
        >>> urdf = as_yourdfpy(robot, [0, 0.2, -0.3, 0, -1, 0])
        >>> urdf.get_transform("tool0", "base_link").shape  # (4, 4) [m]
        (4, 4)
    """
    require("yourdfpy", needed_for="handing a robot to yourdfpy")
    import yourdfpy

    document = robot.document
    values = robot.joint_values(np.zeros(robot.n) if a is None else a)
    unread = {finding.where for finding in visuals(robot).findings} if meshes else set()
    held = yourdfpy.URDF(
        robot=yourdfpy.Robot(
            name=document.name,
            links=[_link(link, document, unread) for link in document.links],
            joints=[_joint(joint) for joint in document.joints],
        ),
        load_meshes=meshes,
        filename_handler=lambda fname: fname,
    )
    held.update_cfg({name: float(values[name]) for name in held.actuated_joint_names})
    return held


def _link(link: LinkSpec, document: UrdfDocument, unread: set[str]) -> yourdfpy.Link:
    import yourdfpy

    inertial = None
    if link.inertial is not None:
        inertial = yourdfpy.Inertial(
            origin=link.inertial.origin, mass=link.inertial.mass, inertia=link.inertial.inertia
        )
    shapes = [
        yourdfpy.Visual(
            name=spec.name or None,
            origin=spec.origin,
            geometry=_geometry(spec, document),
            material=None
            if spec.rgba is None
            else yourdfpy.Material(name="", color=yourdfpy.Color(rgba=np.array(spec.rgba))),
        )
        for spec in document.visuals
        if spec.link == link.name and spec.place not in unread and spec.geometry.kind != "capsule"
    ]
    return yourdfpy.Link(name=link.name, inertial=inertial, visuals=shapes)


def _geometry(spec: VisualSpec, document: UrdfDocument) -> yourdfpy.Geometry:
    import yourdfpy

    size = spec.geometry.size
    match spec.geometry.kind:
        case "box":
            return yourdfpy.Geometry(box=yourdfpy.Box(size=np.array(size)))
        case "cylinder":
            return yourdfpy.Geometry(cylinder=yourdfpy.Cylinder(radius=size[0], length=size[1]))
        case "sphere":
            return yourdfpy.Geometry(sphere=yourdfpy.Sphere(radius=size[0]))
    address = spec.geometry.filename or ""
    path, _ = resolve(address, document.path, document.package_folders)
    return yourdfpy.Geometry(
        mesh=yourdfpy.Mesh(filename=str(path or address), scale=np.array(size))
    )


def _joint(joint: JointSpec) -> yourdfpy.Joint:
    import yourdfpy

    limit = mimic = None
    if joint.moves:
        limit = yourdfpy.Limit(
            effort=joint.effort, velocity=joint.velocity, lower=joint.lower, upper=joint.upper
        )
    if joint.mimic is not None:
        mimic = yourdfpy.Mimic(
            joint=joint.mimic.joint, multiplier=joint.mimic.multiplier, offset=joint.mimic.offset
        )
    return yourdfpy.Joint(
        name=joint.name,
        type=joint.type,
        parent=joint.parent,
        child=joint.child,
        origin=joint.origin,
        axis=joint.axis,
        limit=limit,
        mimic=mimic,
    )
