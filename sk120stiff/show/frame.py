"""Everything one picture shows, computed for a pose and a load.

The static page computes the same numbers in JavaScript (`page/engine.js`); a test in a real browser
holds the two together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import Refusal
from sk120stiff.robot.rotations import joint_motion
from sk120stiff.show.elastic import Elastic
from sk120stiff.show.links import LinkTree
from sk120stiff.stiffness import (
    Definiteness,
    complementary_stiffness,
    definiteness_of,
    symmetric_part,
)

RIGID = 1e-12  # share of the largest principal compliance below which a direction is rigid


@dataclass(frozen=True, eq=False)
class Request:
    """What the controls of the page are set to.

    Attributes
    ----------
    a
        (n,) actuated coordinates [rad or m].
    wrench
        (6,) force [N] and moment [N·m] at the point, base axes.
    point
        (3,) in the frame of the point [m].
    exaggeration
        Factor on every displacement that is drawn.
    """

    a: Array
    wrench: Array
    point: Array
    exaggeration: float = 1.0


@dataclass(frozen=True, eq=False)
class PrincipalAxes:
    """Compliances (3,) [m/N or rad/(N·m)], softest first, and unit directions as rows (3, 3)."""

    values: Array
    directions: Array


@dataclass(frozen=True, eq=False)
class Frame:
    """The answer, in base axes and SI.

    Attributes
    ----------
    links
        (L, 4, 4) placement of every link.
    deflected
        (L, 4, 4) the same under load, displacements exaggerated; None beyond the critical load.
    position, rotation
        (3,) of the point [m], (3, 3) of its frame.
    translation, rotation_axes
        Formulation ("conventional", "enhanced") → principal compliances.
    deflection
        Formula → displacement (3,) of the point [m]; "equilibrium" is missing where none exists,
        "enhanced" where K_θ − K_C is not positive definite.
    K_C_class, stiffness_class
        Definiteness of K_C and of K_θ − K_C over the yielding coordinates.
    softening, stiffening
        Share of the joint stiffness that K_C takes in its softest, and adds in its stiffest
        direction; None where the springs alone are not positive definite, and nothing has a share.
    """

    links: Array
    deflected: Array | None
    position: Array
    rotation: Array
    translation: dict[str, PrincipalAxes]
    rotation_axes: dict[str, PrincipalAxes]
    deflection: dict[str, Array]
    K_C_class: str
    stiffness_class: str
    softening: float | None
    stiffening: float | None

    @property
    def critical_factor(self) -> float:
        """Factor on the load at which K_θ − K_C loses definiteness; infinite if it never does."""
        if self.softening is None:
            return 0.0
        return 1.0 / self.softening if self.softening > 0.0 else float("inf")


def compute_frame(tree: LinkTree, elastic: Elastic, request: Request) -> Frame:
    """Kinematics, compliance, deflection and verdicts of one request.

    Raises
    ------
    Refusal
        The load is exactly critical.
    """
    z = elastic.coordinates(request.a)
    mechanism, C = elastic.mechanism, elastic.tangent(request.a)
    start = mechanism.screws(z, request.point)
    J = start.jacobian
    K_C = complementary_stiffness(start, request.wrench)
    try:  # (K_θ − K_C)⁻¹, rigid coordinates included
        loaded = np.asarray(np.linalg.solve(np.eye(len(z)) - C @ K_C, C))
    except np.linalg.LinAlgError as error:
        raise Refusal("this load is exactly critical: K_θ − K_C is singular") from error
    torques = start.torques(request.wrench)
    deflection = {"conventional": J[:3] @ C @ torques}
    links = place_elastic(tree, elastic, z)
    deflected: Array | None = None
    try:
        rest, position = elastic.rest(request.a, request.wrench, request.point)
    except Refusal:
        pass  # the page says so; every other number still holds
    else:
        deflection["equilibrium"] = position - start.position
        exaggerated = z + request.exaggeration * (rest - z)
        deflected = place_elastic(tree, elastic, exaggerated)
    c, V = yielding_directions(C)
    K_C_soft = symmetric_part(V.T @ K_C @ V)
    shares: Array | None = None
    if (c > 0.0).all():  # else a spring of the model is negative: unstable before any load
        root = np.sqrt(c)
        shares = np.zeros(1)
        if len(c):
            shares = np.asarray(np.linalg.eigvalsh(root[:, None] * K_C_soft * root))
    stable = definiteness_of(np.diag(1.0 / c) - K_C_soft)
    if stable is Definiteness.POSITIVE_DEFINITE:  # else one step leads to a balance that never is
        deflection["enhanced"] = J[:3] @ loaded @ torques
    return Frame(
        links=links,
        deflected=deflected,
        position=start.position,
        rotation=start.rotation,
        translation={
            "conventional": _axes(J[:3], C),
            "enhanced": _axes(J[:3], loaded),
        },
        rotation_axes={
            "conventional": _axes(J[3:], C),
            "enhanced": _axes(J[3:], loaded),
        },
        deflection=deflection,
        K_C_class=definiteness_of(K_C_soft).value if K_C_soft.any() else "zero",
        stiffness_class=stable.value,
        softening=None if shares is None else max(0.0, float(shares[-1])),
        stiffening=None if shares is None else max(0.0, -float(shares[0])),
    )


def yielding_directions(compliance: Array) -> tuple[Array, Array]:
    """Principal compliances (r,) of the coordinates that are not zero, directions (n, r)."""
    values, vectors = np.linalg.eigh(symmetric_part(compliance))
    yields = np.abs(values) > RIGID * np.max(np.abs(values), initial=0.0)
    return values[yields], vectors[:, yields]


def place_elastic(tree: LinkTree, elastic: Elastic, z: Array) -> Array:
    """(L, 4, 4) links when virtual joints move too: each link rides on its joint of the chain."""
    joints = elastic.joint_vector(z)
    links = tree.place(joints)
    if not elastic.n_virtual:
        return links
    chain = elastic.mechanism.chain
    values = joints[chain.coordinates]
    after = np.empty((chain.m, 4, 4))
    T = np.eye(4)
    for k in range(chain.m):
        T = T @ chain.placements[k]
        T = T @ joint_motion(chain.axes[k], bool(chain.revolute[k]), float(values[k]))
        after[k] = T
    carrier = {joint: k for k, joint in enumerate(tree.joints)}
    moved = links.copy()
    for k, anchor in enumerate(tree.anchors(chain.names)):
        if anchor >= 0:
            rigid = links[carrier[chain.names[anchor]]]
            moved[k] = after[anchor] @ np.linalg.inv(rigid) @ links[k]
    return moved


def _axes(J: Array, compliance: Array) -> PrincipalAxes:
    values, vectors = np.linalg.eigh(symmetric_part(J @ compliance @ J.T))
    return PrincipalAxes(values[::-1], vectors[:, ::-1].T)
