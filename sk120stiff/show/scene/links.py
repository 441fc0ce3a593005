"""Where every link of a robot is: the whole tree, off the chain to the tool too."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.robot import Robot
from sk120stiff.robot.kinematics.chain import Chain
from sk120stiff.robot.rotations import joint_motion

FIXED, REVOLUTE, PRISMATIC = 0, 1, 2
_KINDS = {"revolute": REVOLUTE, "continuous": REVOLUTE, "prismatic": PRISMATIC}


@dataclass(frozen=True, eq=False)
class LinkTree:
    """Constants of all joints, one per link but the root, and of what is inserted behind them.

    Attributes:
        names: (L,) link names; the root first.
        joints: (L,) name of the joint that carries each node; empty for the root.
        parents: (L,) index of the parent link, -1 for the root.
        origins: (L, 4, 4) joint placement in the parent link [m].
        axes: (L, 3) unit joint axis.
        kinds: (L,) `FIXED`, `REVOLUTE` or `PRISMATIC`.
        coordinates: (L,) index into the joint vector q, -1 for a fixed joint.
        base: Index of the link that is the base frame.
    """

    names: tuple[str, ...]
    joints: tuple[str, ...]
    parents: Index
    origins: Array
    axes: Array
    kinds: Index
    coordinates: Index
    base: int

    def place(self, q: Array) -> Array:
        """(L, 4, 4) T_base_link of every node for joint values q [rad or m]."""
        T = np.empty((len(self.parents), 4, 4))
        for k in self.order:
            parent = self.parents[k]
            if parent < 0:
                T[k] = np.eye(4)
                continue
            T[k] = T[parent] @ self.origins[k]
            if self.kinds[k] != FIXED:
                T[k] = T[k] @ joint_motion(
                    self.axes[k], self.kinds[k] == REVOLUTE, float(q[self.coordinates[k]])
                )
        return np.asarray(np.linalg.inv(T[self.base]) @ T)

    @cached_property
    def order(self) -> list[int]:
        """All nodes, parents before children."""
        children: dict[int, list[int]] = {}
        for k, parent in enumerate(self.parents.tolist()):
            children.setdefault(parent, []).append(k)
        found = list(children[-1])
        for k in found:
            found.extend(children.get(k, []))
        return found

    def riding(self, chain: Chain) -> LinkTree:
        """The tree with the chain's virtual joints in it, as nodes behind the links.

        What a chain joint carries rides on the virtual joints before it; a link that no joint of
        the chain carries stays where it is.
        """
        joints = list(self.joints)
        nodes = [*self.joints, *(name for name in chain.names if name not in self.joints)]
        extra = len(nodes) - len(joints)
        parents = np.append(self.parents, np.zeros(extra, dtype=np.intp))
        origins = np.concatenate([self.origins, np.zeros((extra, 4, 4))])
        axes = np.concatenate([self.axes, np.zeros((extra, 3))])
        kinds = np.append(self.kinds, np.zeros(extra, dtype=np.intp))
        coordinates = np.append(self.coordinates, np.zeros(extra, dtype=np.intp))
        before = self.base
        for k, name in enumerate(chain.names):
            here = nodes.index(name)
            parents[here], origins[here], axes[here] = before, chain.placements[k], chain.axes[k]
            kinds[here] = REVOLUTE if chain.revolute[k] else PRISMATIC
            coordinates[here] = chain.coordinates[k]
            before = here
        return replace(
            self,
            joints=tuple(nodes),
            parents=parents,
            origins=origins,
            axes=axes,
            kinds=kinds,
            coordinates=coordinates,
        )


def link_tree(robot: Robot) -> LinkTree:
    """All links of a robot, in the joint vector of its coupling."""
    document = robot.document
    names = [document.root]
    for name in names:
        names.extend(joint.child for joint in document.below.get(name, ()))
    index = {name: k for k, name in enumerate(names)}
    coordinate = {name: k for k, name in enumerate(robot.tree.joint_names)}
    parents = np.full(len(names), -1, dtype=np.intp)
    origins = np.tile(np.eye(4), (len(names), 1, 1))
    axes = np.tile(np.array([0.0, 0.0, 1.0]), (len(names), 1))
    kinds = np.zeros(len(names), dtype=np.intp)
    coordinates = np.full(len(names), -1, dtype=np.intp)
    joints = [""] * len(names)
    for k, name in enumerate(names[1:], 1):
        spec = document.above[name]
        joints[k] = spec.name
        parents[k] = index[spec.parent]
        origins[k] = spec.origin
        if spec.name in coordinate:
            axes[k] = spec.axis
            kinds[k] = _KINDS[spec.type]
            coordinates[k] = coordinate[spec.name]
    return LinkTree(
        names=tuple(names),
        joints=tuple(joints),
        parents=parents,
        origins=origins,
        axes=axes,
        kinds=kinds,
        coordinates=coordinates,
        base=index[robot.base_frame],
    )
