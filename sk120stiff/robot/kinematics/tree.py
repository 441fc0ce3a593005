"""A kinematic tree read from clean URDF text: all that Pinocchio does but collisions.

Pinocchio parses, places and weighs; we keep the coupling of mimic joints ourselves, because its own
mimic support refuses or falsifies several derivatives. Every name is checked before Pinocchio sees
it: a wrong frame id would corrupt its memory instead of raising.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import numpy as np
import pinocchio as pin

from sk120stiff.arrays import Array, Mask
from sk120stiff.errors import InputError, meant
from sk120stiff.robot.kinematics.chain import Chain
from sk120stiff.robot.rotations import crossed
from sk120stiff.robot.urdf import captured_stderr


class Tree:
    """All moving joints and frames of a URDF, with Pinocchio's constants and dynamics.

    Joint values are the tangent coordinates ``q`` (m,) in Pinocchio's joint order, one number per
    joint, also for continuous joints.
    """

    def __init__(self, xml: str) -> None:
        with captured_stderr() as said:
            try:
                self._model = pin.buildModelFromXML(xml)  # without its mimic joints, the default
            except (ValueError, RuntimeError) as error:
                raise InputError(
                    f"Pinocchio cannot build this robot: {said.text.strip() or error}",
                    remedy="Repair the URDF at the element named above.",
                ) from error
        if any(joint.nv != 1 for joint in list(self._model.joints)[1:]):
            raise ValueError("a joint with several degrees of freedom reached the kinematic tree")
        self._data = self._model.createData()
        self.joint_names: tuple[str, ...] = tuple(self._model.names)[1:]
        self.frame_names: tuple[str, ...] = tuple(
            frame.name for frame in self._model.frames if frame.type == pin.FrameType.BODY
        )

    @property
    def model(self) -> pin.Model:
        """Pinocchio's own model, for `robot.collision`."""
        return self._model

    def carrier(self, body: int) -> int:
        """The moving joint that carries another one; -1: none."""
        return int(self._model.parents[body + 1]) - 1

    @property
    def m(self) -> int:
        """Number of moving joints."""
        return len(self.joint_names)

    @cached_property
    def axes(self) -> Array:
        """(m, 3) unit joint axes in the joint frames."""
        return np.asarray(self._local_twists[:, :3] + self._local_twists[:, 3:])

    @cached_property
    def revolute(self) -> Mask:
        """(m,) true where the joint turns."""
        return np.asarray(np.linalg.norm(self._local_twists[:, 3:], axis=1) > 0.5)

    @cached_property
    def _local_twists(self) -> Array:
        pin.computeJointJacobians(self._model, self._data, pin.neutral(self._model))
        twists = np.zeros((self.m, 6))
        for k in range(self.m):
            local = pin.getJointJacobian(self._model, self._data, k + 1, pin.LOCAL)
            local = np.reshape(local, (6, self.m))  # a single column comes back flat
            twists[k] = local[:, self._model.joints[k + 1].idx_v]
        return twists

    def joint_index(self, name: str) -> int:
        """Position of a joint in q.

        Raises:
            InputError: There is no such moving joint; the existing ones are listed.
        """
        if name not in self.joint_names:
            raise InputError(
                f"there is no moving joint {name!r}{meant(name, self.joint_names)}",
                remedy=f"Moving joints are: {', '.join(self.joint_names)}.",
            )
        return self.joint_names.index(name)

    def body(self, frame: str, *, where: str | None = None) -> tuple[int, Array]:
        """Moving joint that carries a frame (-1: none), and the frame's (4, 4) placement on it [m].

        `where` the frame was asked for is said of one that is not there.

        Raises:
            InputError: There is no such frame; the existing ones are listed.
        """
        if frame not in self.frame_names:
            raise InputError(
                f"there is no frame {frame!r}{meant(frame, self.frame_names)}",
                where=where,
                remedy=f"Frames are: {', '.join(self.frame_names)}.",
            )
        found = self._model.frames[self._model.getFrameId(frame, pin.FrameType.BODY)]
        # Pinocchio 2, which ROS and NumPy 1.26 may ask for, calls it `parent`.
        carrier = found.parentJoint if hasattr(found, "parentJoint") else found.parent
        return int(carrier) - 1, np.asarray(found.placement.homogeneous)

    def path(self, base: str, tool: str) -> tuple[int, ...]:
        """Moving joints met on the way from one frame to another.

        Raises:
            InputError: The way from `base` to `tool` does not run outwards only.
        """
        start, _ = self.body(base)
        body, _ = self.body(tool)
        joints: list[int] = []
        while body not in (start, -1):
            joints.append(body)
            body = int(self._model.parents[body + 1]) - 1
        if body != start:
            raise InputError(
                f"the frame {tool!r} is not carried by {base!r}",
                remedy="Choose a base frame that lies between the root and the tool.",
            )
        return tuple(reversed(joints))

    def chain(self, base: str, tool: str) -> Chain:
        """Constants of the serial chain from the frame `base` to the frame `tool`."""
        joints = self.path(base, tool)
        _, T_body_base = self.body(base)
        _, T_body_tool = self.body(tool)
        placements = [self._model.jointPlacements[k + 1].homogeneous for k in joints]
        if placements:
            placements[0] = np.linalg.inv(T_body_base) @ placements[0]
            placements.append(T_body_tool)
        else:
            placements = [np.linalg.inv(T_body_base) @ T_body_tool]
        index = np.array(joints, dtype=np.intp)
        return Chain(
            names=tuple(self.joint_names[k] for k in joints),
            placements=np.array(placements),
            axes=self.axes[index],
            revolute=self.revolute[index],
            coordinates=index,
            **dict(zip(("masses", "centres"), self._lumps(joints), strict=True)),
        )

    def _carried(self, joints: tuple[int, ...]) -> Iterator[tuple[int, pin.SE3, pin.Inertia]]:
        """Every body with mass: position of the joint that carries it, place on it, inertia."""
        pin.forwardKinematics(self._model, self._data, self.configuration(np.zeros(self.m)))
        position = {joint + 1: k for k, joint in enumerate(joints)}
        for body in range(1, self.m + 1):
            carrier = body
            while carrier not in position and carrier > 0:
                carrier = int(self._model.parents[carrier])
            if carrier:
                T = self._data.oMi[carrier].inverse() * self._data.oMi[body]
                yield position[carrier], T, self._model.inertias[body]

    def _lumps(self, joints: tuple[int, ...]) -> tuple[Array, Array]:
        """(m,) masses carried by chain joints and (m, 3) their centres, branches at rest."""
        masses, moments = np.zeros(len(joints)), np.zeros((len(joints), 3))
        for k, T, inertia in self._carried(joints):
            masses[k] += inertia.mass
            moments[k] += inertia.mass * T.act(inertia.lever)
        safe = np.where(masses > 0.0, masses, 1.0)[:, None]
        return masses, moments / safe

    def inertias(self, base: str, tool: str) -> Array:
        """(m, 3, 3) inertia of what each joint of a chain carries, branches at rest [kg·m²].

        About the centre of mass (`Chain.centres`), axes of the joint's moving frame.
        """
        joints = self.path(base, tool)
        centres = self._lumps(joints)[1]
        out = np.zeros((len(joints), 3, 3))
        for k, T, inertia in self._carried(joints):
            off = crossed(T.act(inertia.lever) - centres[k])
            out[k] += T.rotation @ inertia.inertia @ T.rotation.T - inertia.mass * off @ off
        return out

    def gravity_torques(self, q: Array, gravity: Array) -> Array:
        """(m,) torques by which gravity drives the joints [N·m or N]: minus the holding torques.

        Args:
            q: (m,) joint values.
            gravity: (3,) acceleration in root axes [m/s²].
        """
        self._model.gravity.linear = np.asarray(gravity, dtype=float)
        held = pin.computeGeneralizedGravity(self._model, self._data, self.configuration(q))
        return -np.asarray(held)

    def configuration(self, q: Array) -> Array:
        """Pinocchio's configuration (nq,) for tangent coordinates q (m,)."""
        values = np.zeros(self._model.nv)
        for k in range(self.m):
            values[self._model.joints[k + 1].idx_v] = q[k]
        start = np.zeros(self._model.nq)
        for joint in list(self._model.joints)[1:]:
            if joint.nq == 2:  # a continuous joint is stored as (cos, sin)
                start[joint.idx_q] = 1.0
        return np.asarray(pin.integrate(self._model, start, values))
