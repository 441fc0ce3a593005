"""A mechanism of the generator as a MuJoCo model, and its rest position by MuJoCo's own forces."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from .generator.mechanism import Mechanism
from .generator.rotations import turn

Array = NDArray[np.float64]


def model_of(
    mechanism: Mechanism, commanded: Array, compliance: Array, point: Array
) -> mujoco.MjModel:
    """One pose as nested bodies; every element is a hinge or slide with its spring."""
    spec = mujoco.MjSpec()
    spec.option.gravity = [0.0, 0.0, -9.81]
    spec.compiler.degree = False
    spec.compiler.boundmass = 1e-12
    spec.compiler.boundinertia = 1e-12
    parent = spec.worldbody
    masses: dict[int, list[tuple[Array, float]]] = {}
    for number, index, centre in mechanism.bodies:
        masses.setdefault(index, []).append((centre, mechanism.arm.bodies[number].mass))
    for k, element in enumerate(mechanism.elements):
        body = parent.add_body(pos=element.shift, quat=_quaternion(element.rotation))
        kind = mujoco.mjtJoint.mjJNT_SLIDE if element.slides else mujoco.mjtJoint.mjJNT_HINGE
        body.add_joint(
            type=kind, axis=element.axis, stiffness=1.0 / compliance[k], springref=commanded[k]
        )
        for centre, mass in masses.get(k, []):
            body.add_geom(
                type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.001, 0, 0], pos=centre, mass=mass
            )
        parent = body
    tool = parent.add_body(pos=mechanism.tool[:3, 3], quat=_quaternion(mechanism.tool[:3, :3]))
    tool.add_site(name="point", pos=point)
    return spec.compile()


def rest_position(
    model: mujoco.MjModel, commanded: Array, compliance: Array, force: Array, moment: Array
) -> Array:
    """Where the point comes to rest under a dead wrench and gravity."""
    data = mujoco.MjData(model)
    data.qpos[:] = commanded
    site = model.site("point").id
    linear, angular = np.zeros((3, model.nv)), np.zeros((3, model.nv))
    for _ in range(60):
        mujoco.mj_forward(model, data)
        mujoco.mj_jacSite(model, data, linear, angular, site)
        left = data.qfrc_passive - data.qfrc_bias + linear.T @ force + angular.T @ moment
        data.qpos[:] += compliance * left
        if np.abs(compliance * left).max() < 1e-13:
            break
    else:
        raise RuntimeError("MuJoCo's arm did not come to rest")
    mujoco.mj_forward(model, data)
    return data.site_xpos[site].copy()


def _quaternion(rotation: Array | None) -> Array:
    out = np.zeros(4)
    matrix = turn(np.array([1.0, 0, 0]), np.zeros(1))[0] if rotation is None else rotation
    mujoco.mju_mat2Quat(out, np.ascontiguousarray(matrix).reshape(-1))
    return out
