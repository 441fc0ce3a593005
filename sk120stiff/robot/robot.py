"""The rigid robot: what moves, what follows, and where every point of it is."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Mask
from sk120stiff.errors import InputError, warn
from sk120stiff.files import html_table
from sk120stiff.robot.description import ControllerRule
from sk120stiff.robot.kinematics.coupling import Coupling, Follower
from sk120stiff.robot.kinematics.screws import Mechanism, Screws
from sk120stiff.robot.kinematics.tree import Tree
from sk120stiff.robot.loops.constraint import Closure
from sk120stiff.robot.loops.coupling import LoopCoupling

if TYPE_CHECKING:
    from sk120stiff.robot.urdf import FrameChoice, UrdfDocument

STANDARD_GRAVITY = 9.80665  # m/s²


@dataclass(frozen=True)
class Linkage:
    """The rod of a closed linkage between two actuated joints (see `robot.yaml`).

    Attributes:
        rod: Link name of the rod.
        drivers: The two actuated joints; the second one turns the crank and is held by the rod.
        corners: Frames at the crank's pivot, at the joint of crank and rod, and at the rod's far
            end.
    """

    rod: str
    drivers: tuple[str, str]
    corners: tuple[str, str, str]


@dataclass(frozen=True, eq=False)
class Robot:
    """Rigid kinematics of an arm in its actuated coordinates; made by `load_robot`.

    Everything that takes coordinates ``a`` takes one pose (n,) or any batch (..., n), in rad for
    joints that turn and m for joints that slide.

    Attributes:
        name: Name of the robot.
        actuated: The n joints that motors drive, in the order of ``a``.
        base_frame, tool_frame: Frames between which the arm is described. All results are in axes
            of `base_frame`.
        choice: The frames that are taken where nobody names any, with the alternatives.
        lower, upper: (n,) joint limits; infinite where none are published.
        followers: Mimic rule of every coupled joint.
        foundation: (3,) point of the base frame about which the base rocks [m].
        gravity: (3,) acceleration in axes of the URDF's root [m/s²].
        controller: How the controller counts the joints, for robot programs.

    Examples:
        >>> import sk120stiff as sk
        >>> sk.load_robot("ur5e")
        <Robot ur5e: shoulder_pan_joint, ...; tool0>
    """

    name: str
    base_frame: str
    tool_frame: str
    actuated: tuple[str, ...]
    lower: Array
    upper: Array
    tree: Tree
    coupling: Coupling
    document: UrdfDocument
    choice: FrameChoice
    source: str
    followers: dict[str, Follower] = field(default_factory=dict)
    locked: dict[str, float] = field(default_factory=dict)
    foundation: Array = field(default_factory=lambda: np.zeros(3))
    gravity: Array = field(default_factory=lambda: np.array([0.0, 0.0, -STANDARD_GRAVITY]))
    linkages: tuple[Linkage, ...] = ()
    controller: ControllerRule = field(default_factory=ControllerRule)
    notes: str = ""

    def __repr__(self) -> str:
        return f"<Robot {self.name}: {', '.join(self.actuated)}; {self.tool_frame}>"

    def _repr_html_(self) -> str:
        """What a notebook shows: the actuated joints with their limits."""
        columns = {
            "joint": self.actuated,
            "": ["slides" if slides else "turns" for slides in self.prismatic],
            "lower": self.lower,
            "upper": self.upper,
            "unit": ["m" if slides else "rad" for slides in self.prismatic],
        }
        return html_table(repr(self), columns)

    @property
    def n(self) -> int:
        """Number of actuated coordinates."""
        return len(self.actuated)

    @property
    def frames(self) -> tuple[str, ...]:
        """Names of all frames (URDF links)."""
        return self.tree.frame_names

    @property
    def rest(self) -> Array:
        """(n,) coordinates at which the robot exists: zero, or the start of its closed loops."""
        if isinstance(self.coupling, LoopCoupling):
            return np.asarray(self.coupling.start[: self.n])
        return np.zeros(self.n)

    @property
    def closures(self) -> tuple[Closure, ...]:
        """Closed loops that `robot.yaml` declares."""
        return self.coupling.closures if isinstance(self.coupling, LoopCoupling) else ()

    @property
    def dependent(self) -> tuple[str, ...]:
        """Joints that closed loops determine."""
        return self.coupling.dependent if isinstance(self.coupling, LoopCoupling) else ()

    @cached_property
    def prismatic(self) -> tuple[bool, ...]:
        """For each actuated joint: does it slide (metres) rather than turn (radians)?"""
        return tuple(not self.tree.revolute[self.tree.joint_index(j)] for j in self.actuated)

    @property
    def kinds(self) -> tuple[str, ...]:
        """``length`` or ``angle`` for each actuated joint, as `units` calls them."""
        return tuple("length" if slides else "angle" for slides in self.prismatic)

    @cached_property
    def _mechanisms(self) -> dict[str, Mechanism]:
        return {}

    def mechanism(self, frame: str | None = None) -> Mechanism:
        """Chain and coupling from the base frame to `frame` (default: the tool).

        Examples:
            >>> import sk120stiff as sk
            >>> robot = sk.load_robot("motoman_sk120")
            >>> robot.mechanism("reflector").n
            6
        """
        name = frame or self.tool_frame
        if name not in self._mechanisms:
            chain = self.tree.chain(self.base_frame, name)
            self._mechanisms[name] = Mechanism(chain, self.coupling)
        return self._mechanisms[name]

    def screws(
        self, a: ArrayLike, frame: str | None = None, point: ArrayLike | None = None
    ) -> Screws:
        """Unit twists of the joints at `point` (3,) [m, axes of `frame`] for coordinates `a`.

        Raises:
            InputError: `a` has another number of coordinates, is not finite, or `frame` does not
                exist.

        Examples:
            >>> import sk120stiff as sk
            >>> robot = sk.load_robot("motoman_sk120")
            >>> robot.screws([0.0] * 6).position.round(3).tolist()  # m
            [1.745, 0.0, 1.35]
        """
        coordinates = self.coordinates(a)
        at = None if point is None else np.asarray(point, dtype=float)
        return self.mechanism(frame).screws(coordinates, at)

    def placement(
        self, a: ArrayLike, frame: str | None = None, point: ArrayLike | None = None
    ) -> Array:
        """(..., 4, 4) T_base_frame, with its origin moved to `point` of the frame [m].

        Examples:
            >>> import sk120stiff as sk
            >>> robot = sk.load_robot("motoman_sk120")
            >>> robot.placement([0.0] * 6)[:3, 3].round(3).tolist()  # m
            [1.745, 0.0, 1.35]
        """
        screws = self.screws(a, frame, point)
        T_base_frame = np.zeros((*screws.position.shape[:-1], 4, 4))
        T_base_frame[..., :3, :3] = screws.rotation
        T_base_frame[..., :3, 3] = screws.position
        T_base_frame[..., 3, 3] = 1.0
        return T_base_frame

    def jacobian(
        self, a: ArrayLike, frame: str | None = None, point: ArrayLike | None = None
    ) -> Array:
        """(..., 6, n) Jacobian of a point by the actuated coordinates, [linear; angular].

        Base axes, Pinocchio's LOCAL_WORLD_ALIGNED. Units m/rad and rad/rad (per m for slides).

        Examples:
            >>> import sk120stiff as sk
            >>> robot = sk.load_robot("motoman_sk120")
            >>> robot.jacobian([[0.0] * 6, [0.1] * 6]).shape
            (2, 6, 6)
        """
        return self.screws(a, frame, point).jacobian

    def joint_values(self, a: ArrayLike) -> dict[str, Array]:
        """Value (...,) of every moving joint, coupled ones included, by joint name.

        Examples:
            >>> import sk120stiff as sk
            >>> robot = sk.load_robot("motoman_sk120")
            >>> robot.joint_values([0, 0.2, 0, 0, 0, 0])["joint_2_l"].item()
            0.2
        """
        q = self.coupling.motion(self.coordinates(a)).q
        return {name: q[..., k] for k, name in enumerate(self.tree.joint_names)}

    @cached_property
    def efforts(self) -> Array:
        """(n,) largest efforts of the actuated joints [N·m or N]; infinite where none is stated."""
        joints = self.document.by_name
        return np.array([joints[name].effort or np.inf for name in self.actuated])

    @cached_property
    def gravity_in_base(self) -> Array:
        """(3,) acceleration of gravity in base axes at the rest position [m/s²]."""
        body, T_body_base = self.tree.body(self.base_frame)
        if body < 0:
            return np.asarray(T_body_base[:3, :3].T @ self.gravity)
        root = next(name for name in self.frames if self.tree.body(name)[0] < 0)
        chain = self.tree.chain(root, self.base_frame)
        swept = chain.sweep(np.zeros(chain.m))
        T_root = self.tree.body(root)[1]
        return np.asarray(swept.rotation.T @ T_root[:3, :3].T @ self.gravity)

    @property
    def on_a_floor(self) -> bool:
        """Does the URDF alone say where weight pulls, along -z of its root?"""
        return np.array_equal(self.gravity, [0.0, 0.0, -STANDARD_GRAVITY])

    def under(self, gravity: Array | None) -> Robot:
        """The robot where weight accelerates so, (3,) in base axes [m/s²]; None: as it does here.

        A URDF is taken as it stands on a floor; an arm on a wall or a ceiling is told so.

        Examples:
            >>> import numpy as np
            >>> import sk120stiff as sk
            >>> on_a_wall = sk.load_robot("ur5e").under(np.array([9.81, 0.0, 0.0]))
            >>> on_a_wall.gravity_torque([0, -1.57, 0, 0, 0, 0]).round(1).tolist()  # N·m
            [14.3, -59.8, -18.4, 0.0, -0.0, 0.0]
        """
        if gravity is None:
            return self
        turns = [replace(self, gravity=axis).gravity_in_base for axis in np.eye(3)]
        return replace(self, gravity=np.asarray(np.array(turns) @ gravity, dtype=np.float64))

    def closes(self, a: ArrayLike, margin: float | None = None) -> Mask:
        """(...,) where the closed loops can be closed; everywhere if there are none.

        `margin` keeps away from dead points, see `LoopCoupling.closes`.

        Examples:
            >>> import sk120stiff as sk
            >>> robot = sk.load_robot("motoman_sk120")
            >>> robot.closes([0.0] * 6).item()
            True
        """
        coordinates = self.coordinates(a)
        if isinstance(self.coupling, LoopCoupling):
            if margin is None:
                return self.coupling.closes(coordinates)
            return self.coupling.closes(coordinates, margin)
        return np.ones(coordinates.shape[:-1], dtype=bool)

    def gravity_torque(self, a: ArrayLike) -> Array:
        """(..., n) torques by which the robot's own weight drives the actuated joints [N·m or N].

        Warns:
            ToolkitWarning: The URDF states no mass at all, so that every torque is zero.

        Examples:
            >>> import sk120stiff as sk
            >>> robot = sk.load_robot("ur5e")
            >>> robot.gravity_torque([0, -0.5, 0.5, 0, 0, 0]).round(1).tolist()  # N·m
            [0.0, 54.7, 18.4, 0.0, 0.0, 0.0]
        """
        coordinates = self.coordinates(a)
        if self.total_mass == 0.0:
            warn(f"{self.name} states no masses: its gravity torques are all zero")
        flat = coordinates.reshape(-1, self.n)
        torques = np.empty_like(flat)
        for k, row in enumerate(flat):
            motion = self.coupling.motion(row)
            torques[k] = self.tree.gravity_torques(motion.q, self.gravity) @ motion.first
        return torques.reshape(coordinates.shape)

    @cached_property
    def total_mass(self) -> float:
        """Sum of all link masses the URDF states, the root's included [kg]."""
        return float(sum(link.mass for link in self.document.links))

    def coordinates(self, a: ArrayLike) -> Array:
        """`a` as an array (..., n) of finite numbers.

        Raises:
            InputError: Another number of coordinates, or a value that is not finite.

        Examples:
            >>> import sk120stiff as sk
            >>> robot = sk.load_robot("motoman_sk120")
            >>> robot.coordinates([0, 1, 0, 0, 0, 0]).dtype
            dtype('float64')
        """
        values = np.asarray(a, dtype=float)
        if values.shape[-1:] != (self.n,):
            raise InputError(
                f"{values.shape[-1] if values.ndim else 1} coordinates given, but {self.name} has "
                f"{self.n} actuated joints",
                remedy=f"Give one value for each of: {', '.join(self.actuated)}.",
            )
        if not np.isfinite(values).all():
            raise InputError("a joint coordinate is not a finite number", where=self.name)
        return values
