"""The rigid geometry that a model believes in: every joint where it truly stands.

Errors of the geometry are constant displacements of coordinates, real or virtual. They are folded
into the fixed transforms before the joints, so that a plain chain of commanded joints stands where
the unloaded model does:

    origin_true = origin_stated · correction

A zero that is off turns the frame behind the joint, and those of all joints that follow it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array, Mask
from sk120stiff.effects import Effect, Elastic, Geometric, Imposed, Weighing, load_case
from sk120stiff.exports.contract import Told
from sk120stiff.model import Model, probing_poses
from sk120stiff.robot import LinearCoupling, Robot
from sk120stiff.robot.rotations import joint_motion

IN_MASSES = "in the masses of the links"
MEASURED = "_measured"  # of the frame in which the measured point stands where it is stated
_SAME = 1e-13  # rad or m: what a shift may differ by between poses and still be one number


@dataclass(frozen=True, eq=False)
class Geometry:
    """A robot's calibrated geometry.

    Attributes:
        joints: The m moving joints from base to tool.
        placements: (m + 1, 4, 4) true transform before each, and to the tool frame; zero offsets
            are in them, so that joint values are commanded ones [m].
        axes, revolute: (m, 3) and (m,) as in `Chain`.
        corrections: Joint, on the way or beside it → (4, 4) correction of its origin.
        tool: (4, 4) correction of the tool frame.
        shift: (n_z,) the constant displacements behind all this, by coordinate of the model.
        of_marker: (n_z,) those that move the measured point alone, not the tool frame.
        by_parameter: (n_z, P) derivative of `shift` by internal values.
        carried, left_out: What became of each effect that is geometry or instrument.
    """

    joints: tuple[str, ...]
    placements: Array
    axes: Array
    revolute: Mask
    corrections: dict[str, Array]
    tool: Array
    shift: Array
    of_marker: Mask
    by_parameter: Array
    carried: tuple[Told, ...]
    left_out: tuple[Told, ...]

    @property
    def measured(self) -> Array:
        """(3,) true minus stated place of the measured point, tool axes [m]."""
        return measured(self.shift, self.of_marker)


def departure(model: Model) -> Array:
    """(N,) how far the unloaded tool stands off the model without what goes with the pose [m].

    At random poses: waves of a gear and the like, which no fixed origin holds.
    """
    geometry, assembly = geometry_of(model), model.assembly
    load_cases = load_case(model.robot, probing_poses(model.robot), np.zeros(6))
    fixed = np.tile(geometry.shift, (load_cases.count, 1))
    fixed[:, : model.robot.n] += load_cases.a
    ways = [assembly.start(load_cases, model.values), fixed]
    true, held = (assembly.mechanism.screws(z).position for z in ways)
    return np.asarray(np.linalg.norm(true - held, axis=1))


def measured(shift: Array, of_marker: Mask) -> Array:
    """(3,) by which shifts (n_z,) move the measured point on the tool [m]."""
    return np.asarray(shift[of_marker].reshape(-1, 3).sum(axis=0))


def geometry_of(model: Model) -> Geometry:
    """The calibrated geometry of a model, effects that are no rigid geometry told by name."""
    robot, assembly = model.robot, model.assembly
    mechanism = assembly.mechanism
    names = [*robot.actuated, *(joint.name for joint in mechanism.virtual)]
    index = {name: k for k, name in enumerate(names)}
    load_cases = load_case(robot, probing_poses(robot), np.zeros(6))
    by_parameter = np.zeros((len(names), len(model.values)))
    of_marker = np.zeros(len(names), dtype=bool)
    carried: list[Told] = []
    left_out: list[Told] = []
    for effect, part in zip(model.effects, assembly.slices, strict=True):
        if isinstance(effect, Elastic | Weighing):
            continue
        acts = bool(model.values[part].any())
        if not isinstance(effect, Geometric):
            left_out += [Told(effect.id, _why_not(effect))] if acts else []
            continue
        shifts = effect.shifts(load_cases)  # (N, k, P)
        why = _not_constant(shifts, model.values[part])
        if why:
            left_out += [Told(effect.id, why)] if acts else []
            continue
        how = "in the origins of the joints"
        rows = [index[name] for name in effect.coordinates(robot)]
        if effect.of_marker:
            of_marker[rows] = True
            how = (
                f"frame {robot.tool_frame}{MEASURED}, in which the measured point stands where the "
                "readings state it (point:); the tool frame stays at the flange"
            )
        by_parameter[rows, part] += shifts[0]
        carried += [Told(effect.id, how)] if acts else []
    shift = by_parameter @ model.values
    placements, corrections, tool = folded(model, np.where(of_marker, 0.0, shift))
    return Geometry(
        robot.mechanism().chain.names,
        placements,
        robot.mechanism().chain.axes,
        robot.mechanism().chain.revolute,
        corrections,
        tool,
        shift,
        of_marker,
        by_parameter,
        tuple(carried),
        tuple(left_out),
    )


def weighing(model: Model, how: str) -> list[Told]:
    """Effects by which the arm weighs otherwise than its URDF states, and what became of them."""
    own = zip(model.effects, model.assembly.slices, strict=True)
    return [
        Told(effect.id, how)
        for effect, part in own
        if isinstance(effect, Weighing) and model.values[part].any()
    ]


def _not_constant(shifts: Array, values: Array) -> str:
    """Why shifts (N, k, P) are no constant of the arm; empty where they are."""
    if np.ptp(shifts, axis=0).max(initial=0.0) > _SAME:
        largest = float(np.abs(shifts @ values).max(initial=0.0))
        return f"changes with the pose, by up to {largest:.2g} rad or m: no fixed origin"
    if not shifts.any():
        return "goes with what a pose does not tell (a series, a side of approach)"
    return ""


def _why_not(effect: Effect) -> str:
    if isinstance(effect, Imposed):
        return "moves with time or temperature: no fixed origin"
    return "belongs to the instrument or to the load, not to the arm"


def folded(model: Model, shift: Array) -> tuple[Array, dict[str, Array], Array]:
    """Placements of the chain shifted by (n_z,), corrections of joints' origins, of the tool."""
    robot, mechanism = model.robot, model.assembly.mechanism
    nominal, chain = robot.mechanism().chain, mechanism.chain
    zeros = _offsets(robot, shift[: robot.n])
    virtual = {joint.name: k for k, joint in enumerate(mechanism.virtual)}
    corrections = {
        name: joint_motion(robot.tree.axes[k], bool(robot.tree.revolute[k]), zeros[k])
        for k, name in enumerate(robot.tree.joint_names)
        if zeros[k] != 0.0
    }
    placements, pending = [], np.eye(4)
    for k, name in enumerate(chain.names):
        pending = pending @ chain.placements[k]
        if name in virtual:
            value = shift[robot.n + virtual[name]]
            pending = pending @ joint_motion(chain.axes[k], bool(chain.revolute[k]), value)
            continue
        placements.append(pending)
        pending = np.eye(4)
    placements.append(pending @ chain.placements[-1])
    moved = bool(shift.any())
    for k, name in enumerate(nominal.names):
        there = np.linalg.inv(nominal.placements[k]) @ placements[k]
        if moved and np.abs(there - np.eye(4)).max() > _SAME:
            corrections[name] = there @ corrections.get(name, np.eye(4))
        placements[k] = nominal.placements[k] @ corrections.get(name, np.eye(4))
    there = np.linalg.inv(nominal.placements[-1]) @ placements[-1]
    tool = there if moved and np.abs(there - np.eye(4)).max() > _SAME else np.eye(4)
    placements[-1] = nominal.placements[-1] @ tool
    return np.array(placements), corrections, tool


def _offsets(robot: Robot, zeros: Array) -> Array:
    """(q,) by which every joint of the tree stands further than commanded [rad or m].

    What closed loops make of it is left to whoever closes them.
    """
    if isinstance(robot.coupling, LinearCoupling):
        return np.asarray(robot.coupling.A @ zeros)
    out = np.zeros(len(robot.tree.joint_names))
    for joint, value in zip(robot.actuated, zeros, strict=True):
        out[robot.tree.joint_index(joint)] = value
    return out
