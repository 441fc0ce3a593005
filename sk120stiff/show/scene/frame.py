"""Everything a page shows at one moment: links and stiffness under load at a pose.

A static page computes the same numbers in JavaScript (`page/engine.js`) from one serialised
mechanism; a test holds the two together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import Refusal
from sk120stiff.show.scene.elastic import Elastic
from sk120stiff.show.scene.links import LinkTree
from sk120stiff.stiffness import UnderLoad, under_load

BEFORE = (
    ("coordinates", "position", "rotation", "compliance_conventional", "compliance_enhanced")
    + ("K_C", "stiffness_class", "complementary_class", "critical", "stiffening")
    + ("deflection_conventional", "deflection_enhanced")
)
AT_REST = ("loaded_coordinates", "deflection_equilibrium")


@dataclass(frozen=True, eq=False)
class Request:
    """What the controls of the page are set to.

    Attributes:
        a: (n,) actuated coordinates [rad or m].
        wrench: (6,) force [N] and moment [N·m] at the point, base axes.
        point: (3,) in the frame of the point [m].
        exaggeration: Factor on every displacement that is drawn.
    """

    a: Array
    wrench: Array
    point: Array
    exaggeration: float = 1.0


@dataclass(frozen=True, eq=False)
class Frame:
    """The answer, in base axes and SI.

    Attributes:
        links: (L, 4, 4) placement of every link before the load.
        deflected: (L, 4, 4) the same under load, displacements exaggerated; None beyond the
            critical load.
        found: Stiffness under the load, the quantities of `BEFORE`; and of `AT_REST` where the arm
            finds an exact equilibrium.
    """

    links: Array
    deflected: Array | None
    found: UnderLoad


def compute_frame(tree: LinkTree, elastic: Elastic, request: Request) -> Frame:
    """Placement of the links and stiffness under load of one request.

    Raises:
        Refusal: The load is exactly critical, or the springs do not hold the arm's own weight.
    """
    arm, nodes = elastic.at(request.point), tree.riding(elastic.mechanism.chain)

    def place(z: Array) -> Array:
        return nodes.place(elastic.joint_values(z))[: len(tree.names)]

    try:
        found = under_load(arm, request.a, request.wrench, BEFORE + AT_REST)
    except Refusal:  # the page says so; every other number still holds
        found = under_load(arm, request.a, request.wrench, BEFORE)
    if np.isnan(found.of("compliance_enhanced")).any():
        raise Refusal("this load is exactly critical: K_θ − K_C is singular")
    z = found.of("coordinates")
    if found.loaded_coordinates is None:
        return Frame(place(z), None, found)
    moved = z + request.exaggeration * (found.loaded_coordinates - z)
    return Frame(place(z), place(moved), found)
