"""The mechanism of a scene as the JSON from which a page without a server computes."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import LinearElastic, load_case
from sk120stiff.errors import InputError
from sk120stiff.model import ModelCompliance, probing_poses
from sk120stiff.robot import LinearCoupling
from sk120stiff.show.scene.scene import Scene
from sk120stiff.show.scene.torque_laws import law_terms
from sk120stiff.stiffness import ConstantCompliance

HELD = "one effect is held as it is at the first pose, unloaded: this page cannot follow it"
DEGREE = 5  # highest angle of a Fourier series, as many times a joint's: twice what a linkage needs
MOST_JOINTS = 3  # on which one compliance may depend
GOOD = 1e-9  # share of its size by which a series may be off

Term = dict[str, Any]


def serialised(scene: Scene) -> dict[str, Any]:
    """Coupling q = A z + b, tree, chain with its masses, and compliance; matrices by columns.

    Raises:
        InputError: The joints are coupled nonlinearly, which the page cannot follow.
    """
    robot, arm = scene.robot, scene.elastic.arm
    coupling = arm.mechanism.elastic or arm.mechanism.coupling
    if not isinstance(coupling, LinearCoupling):
        raise InputError(
            "the joints of this robot are coupled nonlinearly, which a page without a server "
            "cannot follow",
            where=robot.name,
            remedy="Use the live view: sk120stiff view.",
        )
    chain = arm.mechanism.chain
    nodes = scene.tree.riding(chain)
    first = scene.first_pose[None]
    weight = arm.weight_at(first)
    laws = None if isinstance(arm, ConstantCompliance) else law_terms(arm)
    constant, terms = _compliance(arm, first, without_laws=laws is not None)
    shift = arm.start(first)[0]
    shift[: robot.n] -= first[0]
    return {
        "drives": robot.n,
        "A": coupling.A.tolist(),
        "b": coupling.b.tolist(),
        "shift": shift.tolist(),
        "compliance": constant.tolist(),
        "terms": terms,
        "laws": laws or [],
        "gravity": None if weight is None else weight.gravity.tolist(),
        "chain": {
            "nodes": [nodes.joints.index(name) for name in chain.names],
            "end": chain.placements[-1].T.ravel().tolist(),
            "masses": chain.masses.tolist(),
            "centres": chain.centres.tolist(),
        },
        "tree": {
            "order": nodes.order,
            "links": len(nodes.names),
            "parents": nodes.parents.tolist(),
            "origins": [T.T.ravel().tolist() for T in nodes.origins],
            "axes": nodes.axes.tolist(),
            "kinds": nodes.kinds.tolist(),
            "coordinates": nodes.coordinates.tolist(),
            "base": nodes.base,
        },
    }


def follows_pose_and_load(arm: ConstantCompliance | ModelCompliance) -> bool:
    """Does the serialised mechanism hold all that the arm does?"""
    if isinstance(arm, ConstantCompliance):
        return True
    return law_terms(arm) is not None and _series(arm) is not None


def _compliance(
    arm: ConstantCompliance | ModelCompliance, first: Array, *, without_laws: bool
) -> tuple[Array, list[Term]]:
    """(n, n) at the first pose less what changes, and the terms that bring it back."""
    n = arm.mechanism.n
    if without_laws and isinstance(arm, ModelCompliance):
        held = arm.linear_at(first).reshape(-1, n, n)[0]
    else:
        held = arm.compliance_at(first).reshape(-1, n, n)[0]
    found = None if isinstance(arm, ConstantCompliance) else _series(arm)
    if not found:
        return held, []
    terms, now = found, held.copy()
    for term in terms:
        i, j = term["at"]
        value = series_at(term, first)[0]
        now[i, j] -= value
        if i != j:
            now[j, i] -= value
    return now, terms


def _series(arm: ModelCompliance) -> list[Term] | None:
    """Fourier series of every compliance that changes with the pose; None where one is none."""
    model = arm.model
    names = [*model.robot.actuated, *(joint.name for joint in arm.mechanism.virtual)]
    terms: list[Term] = []
    for effect, part in zip(model.effects, model.assembly.slices, strict=True):
        if not isinstance(effect, LinearElastic):
            continue
        values = model.values[part]

        def own(a: Array, effect: LinearElastic = effect, values: Array = values) -> Array:
            patterns = effect.patterns(load_case(model.robot, a, np.zeros(6)))
            block = np.tensordot(values, patterns, axes=1)
            return np.asarray(np.broadcast_to(block, (len(a), *block.shape[-2:])))

        if np.ptp(own(probing_poses(model.robot)), axis=0).any():
            index = [names.index(name) for name in effect.coordinates(model.robot)]
            for i, j in product(range(len(index)), repeat=2):
                if i > j:
                    continue
                term = _term(model.robot.prismatic, lambda a, i=i, j=j: own(a)[:, i, j], arm)
                if term is None:
                    return None
                terms.append({"at": [index[i], index[j]], **term})
    return terms


def _term(slides: tuple[bool, ...], value: Any, arm: ModelCompliance) -> Term | None:
    """A series that is the value, or one over it, at all poses (N, n); None where there is none."""
    probes = probing_poses(arm.model.robot)
    moves = []
    for joint in range(probes.shape[1]):
        moved = probes.copy()
        moved[:, joint] += 0.37
        if np.abs(value(moved) - value(probes)).max() > 1e-13 * np.abs(value(probes)).max():
            moves.append(joint)
    if len(moves) > MOST_JOINTS or any(slides[joint] for joint in moves):
        return None
    count = 2 * DEGREE + 1
    angles = 0.1 + 2.0 * np.pi * np.arange(count) / count
    grid = np.array(list(product(angles, repeat=len(moves))))
    a = np.zeros((len(grid), probes.shape[1]))
    a[:, moves] = grid
    samples = value(a)
    orders = np.array(list(product(range(-DEGREE, DEGREE + 1), repeat=len(moves))))
    waves = np.exp(-1j * grid @ orders.T)  # (samples, orders)
    for inverse in (False, True):
        if inverse and not samples.all():
            break
        coefficients = (1.0 / samples if inverse else samples) @ waves / len(grid)
        kept = np.abs(coefficients) > 1e-12 * np.abs(coefficients).max()
        term: Term = {
            "joints": moves,
            "orders": orders[kept].tolist(),
            "real": coefficients.real[kept].tolist(),
            "imaginary": coefficients.imag[kept].tolist(),
            "inverse": inverse,
        }
        there = value(probes)
        if np.abs(series_at(term, probes) - there).max() <= GOOD * np.abs(there).max():
            return term
    return None


def series_at(term: Term, a: Array) -> Array:
    """(N,) value of a term at poses (N, n), as the page computes it."""
    phase = a[:, term["joints"]] @ np.array(term["orders"]).T
    total = np.cos(phase) @ np.array(term["real"]) - np.sin(phase) @ np.array(term["imaginary"])
    return np.asarray(1.0 / total if term["inverse"] else total)
