"""Exact derivatives of where a loaded arm stands, and of what is read of it.

One adjoint solve per reading gives them all: with N = I − C K_C at the equilibrium (K_C of all that
the load does as the arm moves: what follows the tool turns with it),
∂x/∂p = (J N⁻¹) ∂(s + e)/∂p, s what moves by itself and e what yields.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import LinearElastic, LoadCases
from sk120stiff.effects.switching import Switching
from sk120stiff.model.assembly import Assembly
from sk120stiff.model.standing import Solution, Standing
from sk120stiff.model.true_load import TrueLoad
from sk120stiff.robot import Screws
from sk120stiff.stiffness import Equilibrium, complementary_stiffness, follower_stiffness
from sk120stiff.stiffness.wrench import rotate


def standing_sensitivities(assembly: Assembly, solution: Solution, values: Array) -> Array:
    """(N, 3, P) exact derivative of where the loaded point stands, base axes.

    By the parameters of the arm itself: those of load and reading errors have no part in it.
    """
    rest = solution.rest
    adjoint = rest.adjoint(rest.screws.linear_jacobian, assembly.soft(values))
    return _standing(assembly, solution, values, adjoint)


def _standing(assembly: Assembly, solution: Standing, values: Array, adjoint: Array) -> Array:
    load_cases, rest = solution.load_cases, solution.rest
    P = int(assembly.slices[-1].stop) if assembly.slices else 0
    out = np.zeros((load_cases.count, adjoint.shape[1], P))
    hung = rest.torques + rest.weights
    for effect, part, index in assembly.elastic:
        torques = solution.onset if isinstance(effect, Switching) else rest.torques
        if isinstance(effect, LinearElastic):
            torques = hung
        found = effect.by_parameter(torques[:, index], load_cases, values[part])
        out[:, :, part] += adjoint[:, :, index] @ found
    for shifted, part, index in assembly.geometric:
        if shifted.marks(load_cases):
            out[:, :3, part] += rest.screws.rotation @ shifted.shifts(load_cases)
            continue
        out[:, :, part] += adjoint[:, :, index] @ shifted.shifts(load_cases)
    for moving, part, index in assembly.imposed:
        out[:, :, part] += adjoint[:, :, index] @ moving.shifts(load_cases)
    if len(assembly.weighing):
        out[:, :, assembly.weighing] += _by_weight(assembly, rest, adjoint)
    if solution.begun is not None and assembly.geometric:
        change = _onset_by_geometry(assembly, solution, solution.begun, P)
        _add_onset(out, assembly, solution, values, adjoint, change)
    return out


def _onset_by_geometry(assembly: Assembly, solution: Standing, begun: Screws, P: int) -> Array:
    """(N, n_z, P) derivative of the load's torques at the unloaded pose by errors of geometry."""
    load_cases, load = solution.load_cases, solution.load
    K = complementary_stiffness(begun, load.at(begun.rotation))
    if load.follower is not None:
        K = K + follower_stiffness(begun, rotate(begun.rotation, load.follower))
    change = np.zeros((*K.shape[:2], P))
    for shifted, part, index in assembly.geometric:
        if not shifted.marks(load_cases):
            change[:, :, part] = K[:, :, index] @ shifted.shifts(load_cases)
    return change


def _add_onset(
    out: Array,
    assembly: Assembly,
    solution: Standing,
    values: Array,
    adjoint: Array,
    change: Array,
) -> None:
    """Add what changes (N, n_z, P) of the torques do by which laws jump and remember."""
    for effect, part, index in assembly.elastic:
        if not isinstance(effect, Switching) or not values[part].any():
            continue
        onset, own = solution.onset[:, index], values[part]
        found = effect.by_onset(onset, change[:, index], solution.load_cases, own)
        if found is not None:
            out += adjoint[:, :, index] @ found


def pose_sensitivities(assembly: Assembly, stood: Standing, values: Array) -> Array:
    """(N, 6, P) exact derivative of where the point stands and how it is turned, base axes."""
    adjoint = stood.rest.adjoint(stood.rest.screws.jacobian, assembly.soft(values))
    out = _standing(assembly, stood, values, adjoint)
    _add_loads(out, assembly, stood, values, adjoint)
    return out


def reading_sensitivities(assembly: Assembly, solution: Solution, values: Array) -> Array:
    """(N, 3, P) exact derivative of the readings by the internal parameter values."""
    return _as_read(solution, _since_zero(assembly, solution, values))


def moving_sensitivities(assembly: Assembly, solution: Solution, values: Array) -> Array:
    """(N, 6, P) the same, and how the tool's axes under the load turn, axes of the readings.

    Against those without load, that is: of R = R_load R_0ᵀ by ω_load - R ω_0.
    """
    return _as_read(solution, _since_zero(assembly, solution, values, solution.turn))


def _since_zero(
    assembly: Assembly, solution: Solution, values: Array, turn: Array | None = None
) -> Array:
    """(N, k, P) derivative of what the point moves from its zero reading on, base axes.

    With `turn` (N, 3, 3), the rotation of the tool since then, of what it turns as well.
    """
    load_cases, rest, before = solution.load_cases, solution.rest, solution.unloaded
    soft = assembly.soft(values)
    J, J_0 = rest.screws.linear_jacobian, before.screws.linear_jacobian
    on = np.eye(3)
    if turn is not None:
        J, J_0 = rest.screws.jacobian, before.screws.jacobian
        on = np.tile(np.eye(6), (load_cases.count, 1, 1))
        on[:, 3:, 3:] = turn
    adjoint = rest.adjoint(J, soft)  # (N, k, n_z)
    weighs = assembly.mechanism.chain.weighs
    bare = before.adjoint(J_0, soft) if weighs else J_0
    begin = solution.begin
    adjoint_0, weights = bare[begin], before.weights[begin]
    if turn is not None:
        adjoint_0 = on @ adjoint_0
    out = _standing(assembly, solution, values, adjoint)
    for effect, part, index in assembly.elastic:
        if isinstance(effect, LinearElastic) and weighs:
            found = effect.by_parameter(weights[:, index], load_cases, values[part])
            out[:, :, part] -= adjoint_0[:, :, index] @ found
    for shifted, part, index in assembly.geometric:
        out[:, :, part] -= adjoint_0[:, :, index] @ shifted.shifts(load_cases)
    if len(assembly.weighing):
        out[:, :, assembly.weighing] -= on @ _by_weight(assembly, before, bare)[begin]
    _add_loads(out, assembly, solution, values, adjoint)
    return out


def _as_read(solution: Solution, moved: Array) -> Array:
    """(N, k, P) derivative of displacements and turns (base axes) as the instrument states them."""
    axes = np.swapaxes(solution.load_cases.reading_axes, -1, -2)
    turn = axes @ solution.readings.matrix
    if (turn != np.eye(3)).any():
        parts = [turn @ moved[:, :3]]
        if moved.shape[1] > 3:
            parts.append(axes @ moved[:, 3:])
        moved = np.concatenate(parts, axis=1)
    for part, columns in solution.readings.columns:
        moved[:, :3, part] += axes @ columns
    return moved


def _by_weight(assembly: Assembly, rest: Equilibrium, adjoint: Array) -> Array:
    """(N, k, 1) derivative by the arm's true weight over the stated one."""
    if rest.weight is None:
        return np.zeros((*adjoint.shape[:-1], 1))
    stated = rest.screws.gravity_torques(assembly.robot.gravity_in_base)
    return np.asarray(adjoint @ (rest.weight.compliance @ stated[..., None]))


def _add_loads(
    out: Array, assembly: Assembly, solution: Standing, values: Array, adjoint: Array
) -> None:
    """Add the derivatives (N, k, P) by the parameters of the load errors."""
    load_cases, rest = solution.load_cases, solution.rest
    load = solution.load
    if not (load.of_steady or load.of_follower):
        return
    loaded = rest.screws.at(load_cases.force_point)
    per_wrench = adjoint @ rest.compliance @ np.swapaxes(loaded.jacobian, -1, -2)  # (N, k, 6)
    for part, columns in _by_load(load_cases, load, loaded.rotation):
        out[:, :, part] += per_wrench @ columns
    if solution.begun is not None:
        J = solution.begun.jacobian
        change = np.zeros((load_cases.count, J.shape[-1], out.shape[-1]))
        for part, columns in _by_load(load_cases, load, solution.begun.rotation):
            change[:, :, part] += np.swapaxes(J, -1, -2) @ columns
        _add_onset(out, assembly, solution, values, adjoint, change)


def _by_load(
    load_cases: LoadCases, load: TrueLoad, rotation: Array
) -> Iterator[tuple[slice, Array]]:
    """Of each load error its part of the values and (N, 6, p) what it does to the load, base axes.

    `rotation` (N, 3, 3) is of the tool with which a follower turns.
    """
    for axes, of in ((load_cases.rotation, load.of_steady), (rotation, load.of_follower)):
        for part, columns in of:
            halves = columns.reshape(len(columns), 2, 3, -1)  # forces, moments
            yield part, np.einsum("nij,nhjp->nhip", axes, halves).reshape(columns.shape)
