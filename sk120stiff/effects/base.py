"""The contract of an effect: one physical cause with a name, a place, parameters and a law.

It enters in one of eight ways, each of them one base class:

=============  ==========================================================  ======================
class          what it changes                                             example
=============  ==========================================================  ======================
`Elastic`      elongation of coordinates under load, e(τ)                  joint springs, a beam
`Geometric`    where the unloaded arm really is, z₀                        joint offset
`Imposed`      where coordinates go by themselves after zero, z₀ + S·p     creep, warming up
`Weighing`     the arm's own weight, (1 + Σ p) of what is stated           masses of links
`LoadError`    the load, W_true = W + (S·p) W + o·p in sensor axes         force bias
`ReadingError` the displacement read, d_read = d + (S·p) d + o·p           tracker misalignment
`Viewpoint`    the axes in which positions are stated, x = R(p) X + t(p)   tracker's frame
`Mounting`     the axes of the target on the tool, R_read = R_tool R(p)    a turned target
=============  ==========================================================  ======================

So a misread force never poses as a spring. A new effect is one file and one line in `catalogue.py`,
or ``CATALOGUE + MyEffect`` from outside; what else has to be known of it is a trait here.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Self

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.elongation import Elongation
from sk120stiff.effects.form import Form
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.options import Options
from sk120stiff.effects.parameter import REFERENCE_LENGTH, ParameterSpec
from sk120stiff.effects.places import USUAL_PLACES
from sk120stiff.robot import Robot, VirtualJoint
from sk120stiff.robot.anatomy import arm_length

SPRINGS = "joint_springs"


@dataclass(frozen=True)
class Effect(ABC):
    """One physical cause at one place.

    Attributes:
        name: Public identifier (class attribute).
        place: What `where` names, in words (class attribute).
        equation: The law, in symbols that `axes` and the parameters' meanings explain (class
            attribute).
        says: What happens, in words, as a sentence in which ``{where}`` is the place (class
            attribute; or `sentence` says it).
        axes: The frame in which its parameters are stated (class attribute).
        also: By which names of parameters its other laws are told, and what those mean (class
            attribute).
        former: Names under which files of earlier versions hold a parameter with the other sign,
            and its name now (class attribute).
        random_effects: The parameters are draws of one size (class attribute).
        bends_a_spring: It changes the spring of its joint: there must be one (class attribute).
        inexact: Share of what it explains by which real parts depart from it (class attribute).
        joint_spring: Its one parameter is the stiffness of its actuated joint (class attribute).
        rare: Few arms have what does it (class attribute).
        of_gear: A law of a joint's gear: what one leaves over looks like another (class attribute).
        of_transmission: An error of what turns the joint, not of its axis (class attribute).
        twins: Names of effects that some experiments make one with this one, at the same place and
            with either sign (class attribute).
        needs, advice: What readings must hold for its law, in words; what to do about it before
            anything else, a sentence (class attributes).
        calibrated: Its parameters are errors of an instrument that was calibrated: they are no
            larger than usual, whether readings tell them or not (class attribute).
        only_absolute: Positions show it, displacements hardly ever (class attribute).
        where: URDF joint or link at which it acts; ``sensor`` or ``tracker`` for instruments.
        scale: Length of the arm over `REFERENCE_LENGTH`: what is usual and what is plausible goes
            with it.

    Examples:
        >>> import sk120stiff as sk
        >>> robot = sk.load_robot("motoman_sk120")
        >>> tilt = sk.effect(robot, "joint_tilt", "joint_2_l")
        >>> [parameter.name for parameter in tilt.parameters]
        ['stiffness_along', 'stiffness_across']
    """

    where: str
    scale: float = 1.0

    name: ClassVar[str]
    place: ClassVar[str] = "a place of the arm"
    equation: ClassVar[str] = ""
    says: ClassVar[str]
    axes: ClassVar[str] = ""
    also: ClassVar[str] = ""
    former: ClassVar[Mapping[str, str]] = {}
    random_effects: ClassVar[bool] = False
    bends_a_spring: ClassVar[bool] = False
    inexact: ClassVar[float] = 0.0
    joint_spring: ClassVar[bool] = False
    rare: ClassVar[bool] = False
    of_gear: ClassVar[bool] = False
    of_transmission: ClassVar[bool] = False
    twins: ClassVar[tuple[str, ...]] = ()
    needs: ClassVar[str] = ""
    advice: ClassVar[str] = ""
    calibrated: ClassVar[bool] = False
    only_absolute: ClassVar[bool] = False

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Effect:
        """The effect at one place of a robot."""
        return cls(where, scale_of(robot))

    @classmethod
    def options_of(cls, parameters: Mapping[str, str]) -> Options:
        """What it was told when parameters of these names, and their units, were written."""
        return Options(shape=tuple(parameters))

    @classmethod
    def sample(cls) -> Self:
        """The effect at no place in particular, to be described."""
        return cls(cls.place)

    @property
    def id(self) -> str:
        """``name:where``."""
        return f"{self.name}:{self.where}"

    @property
    @abstractmethod
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """What is to be known about it."""

    def sentence(self) -> str:
        """What happens, in plain words, as a full sentence: `says`, of this place.

        Examples:
            >>> import sk120stiff as sk
            >>> robot = sk.load_robot("motoman_sk120")
            >>> sk.effect(robot, "base_rocking").sentence()
            'The base rocks on its foundation.'
        """
        return self.says.format(where=self.where)

    def told(self, values: Mapping[str, float]) -> str:
        """`sentence`, where values of the parameters by name say more of it.

        Examples:
            >>> import sk120stiff as sk
            >>> gear = sk.effect(sk.load_robot("motoman_sk120"), "gear_hardening", "joint_2_l")
            >>> gear.told({"quadratic": 1e-9, "cubic": 0.0})
            'The gear of joint_2_l hardens: it gets stiffer as its torque grows.'
        """
        return self.sentence()

    @property
    def law_prior(self) -> float:
        """Weight of this law among the less usual ones of its effect, before any measurement."""
        return 1.0

    @classmethod
    def places(cls, robot: Robot) -> tuple[str, ...]:
        """Every `where` at which the effect can act on this robot.

        By default what `place` names: an instrument, a frame, every actuated joint or every link.

        Examples:
            >>> import sk120stiff as sk
            >>> robot = sk.load_robot("motoman_sk120")
            >>> sk.CATALOGUE["link_torsion"].places(robot)
            ('link_1_s', 'link_2_l', 'link_3_u')
        """
        return USUAL_PLACES[cls.place](robot)

    def special_case_of(self, robot: Robot) -> str | None:
        """Id of a more general effect by whose name this one is looked for; None: by its own.

        Examples:
            >>> import sk120stiff as sk
            >>> robot = sk.load_robot("motoman_sk120")
            >>> sk.effect(robot, "link_bending", "link_6_t").special_case_of(robot)
            'tool_compliance:tool0'
        """
        return None

    @property
    def ties(self) -> tuple[tuple[int, ...], ...]:
        """Groups of parameters that are equal where the part is as stiff one way as the other."""
        return ()

    @property
    def couplings(self) -> tuple[tuple[int, int, int], ...]:
        """Parameters (i, j, k) of which k couples i and j: no spring has k² > i j."""
        return ()

    def applies_to(self, load_cases: LoadCases) -> bool:
        """Do these readings hold what the law needs (an order, branches, a weight)?"""
        return load_cases.absolute or not self.only_absolute

    def other_laws(self, load_cases: LoadCases) -> tuple[Effect, ...]:
        """The same effect at the same place by other laws, where more than one is usual."""
        return ()

    def nearby_laws(self, load_cases: LoadCases) -> tuple[Effect, ...]:
        """Laws close to this one, once it is in the model; not beside model-form error."""
        return ()

    def laws_at_positions(self, load_cases: LoadCases) -> tuple[Effect, ...]:
        """Other laws of it, linear in as many parameters, of which positions choose one."""
        return ()

    @property
    def form(self) -> Form[Effect] | None:
        """Numbers of its law that may lie between those that are tried; None: it has none."""
        return None


class Moving(Effect):
    """An effect that has to do with coordinates: those of motors, or of joints of its own."""

    def virtual_joints(self, robot: Robot) -> tuple[VirtualJoint, ...]:
        """Joints that the effect adds to the chain; none where motors' coordinates move."""
        return ()

    def coordinates(self, robot: Robot) -> tuple[str, ...]:
        """Names of the k coordinates that move: own virtual joints, else the actuated joint."""
        return tuple(joint.name for joint in self.virtual_joints(robot)) or (self.where,)


class Elastic(Moving):
    """An effect that lets coordinates yield under load.

    Attributes:
        yields_under: Completes "the moment that ..." (of coordinates that shift: "the force that
            ..."), ``{where}`` being the place: that load is what a gap may go with. Without it
            nothing is said of where such a cause lives (class attribute).
    """

    yields_under: ClassVar[str] = ""

    def free_form(self) -> Elastic:
        """The same with as many parameters as its kind may have."""
        return self

    @abstractmethod
    def elongation(self, torques: Array, load_cases: LoadCases, values: Array) -> Elongation:
        """Law e(τ) for torques (N, k) [N·m or N] and internal parameter values (P,)."""

    def by_parameter(self, torques: Array, load_cases: LoadCases, values: Array) -> Array:
        """(N, k, P) derivative of `elongation` by the internal parameters."""
        return self.elongation(torques, load_cases, values).by_parameter


class LinearElastic(Elastic):
    """Elongation linear in torque and in parameters: e = Σ_p values[p] · pattern_p τ."""

    @abstractmethod
    def patterns(self, load_cases: LoadCases) -> Array:
        """(P, k, k) or (P, N, k, k) symmetric compliance per unit of each parameter."""

    def patterns_at(self, load_cases: LoadCases) -> Array:
        """`patterns` of these readings, worked out once."""
        known = load_cases.patterns
        if self not in known:
            known[self] = self.patterns(load_cases)
        return known[self]

    def by_parameter(self, torques: Array, load_cases: LoadCases, values: Array) -> Array:
        """See `Elastic.by_parameter`: it does not go with the values."""
        patterns = self.patterns_at(load_cases)
        indices = "pij,nj->nip" if patterns.ndim == 3 else "pnij,nj->nip"
        return np.asarray(np.einsum(indices, patterns, torques))

    def elongation(self, torques: Array, load_cases: LoadCases, values: Array) -> Elongation:
        """See `Elastic.elongation`."""
        by_parameter = self.by_parameter(torques, load_cases, values)
        C = np.tensordot(values, self.patterns_at(load_cases), axes=1)
        return Elongation(
            value=by_parameter @ values,
            by_torque=np.broadcast_to(C, (*torques.shape, torques.shape[-1])),
            by_parameter=by_parameter,
        )


class AxisByAxis(LinearElastic):
    """Parameter k is the compliance of coordinate k alone, the same at all poses."""

    def patterns(self, load_cases: LoadCases) -> Array:
        """A one on the diagonal each."""
        return np.array([np.diag(row) for row in np.eye(len(self.parameters))])


class Geometric(Moving):
    """The rigid geometry is wrong: coordinates start from elsewhere, z₀ + Σ_p values[p] s_p.

    Attributes:
        of_marker: Of positions it moves the marker alone, not what hangs there (class attribute).
    """

    of_marker: ClassVar[bool] = False

    def marks(self, load_cases: LoadCases) -> bool:
        """Does it move the marker of these readings, and nothing of the arm?"""
        return self.of_marker and load_cases.absolute

    def shifts(self, load_cases: LoadCases) -> Array:
        """(N, k, P) shift of the coordinates per unit of a parameter.

        Parameter k shifts coordinate k alone, at all poses alike, unless the effect says otherwise.
        """
        P = len(self.parameters)
        return np.broadcast_to(np.eye(P), (load_cases.count, P, P))


class Imposed(Moving):
    """Coordinates move by themselves, whatever the load is: z₀ + Σ_p values[p] s_p.

    They do so between the zero reading and the reading, so the unloaded arm stands where it should:
    time passes, a link warms up, a clamp creeps.
    """

    @abstractmethod
    def shifts(self, load_cases: LoadCases) -> Array:
        """(N, k, P) movement of the coordinates since the zero reading, per unit of a parameter.

        Zero where the readings do not hold what it goes with (a time, an order).
        """


class Weighing(Effect):
    """The arm's own weight, not a payload's, is 1 + Σ_p values[p] times what its URDF states."""


class Misreading(Effect):
    """x_out = x + Σ_p values[p] (S_p x + o_p)."""

    @cached_property
    @abstractmethod
    def generators(self) -> Array:
        """(P, d, d) matrices S_p."""

    def offsets(self, load_cases: LoadCases) -> Array:
        """(N, d, P) constants o_p; zero unless the effect adds something of its own."""
        P, d, _ = self.generators.shape
        return np.zeros((load_cases.count, d, P))

    def columns(self, x: Array, load_cases: LoadCases) -> Array:
        """(N, d, P) derivative of the output by the parameters, for inputs x (N, d)."""
        proportional = np.einsum("pij,nj->nip", self.generators, x)
        return np.asarray(proportional + self.offsets(load_cases))

    def matrix(self, values: Array, load_cases: LoadCases) -> Array:
        """(d, d) derivative of the output by the input; (N, d, d) where poses differ."""
        identity = np.eye(self.generators.shape[-1])
        return np.asarray(identity + np.tensordot(values, self.generators, axes=1))


class LoadError(Misreading):
    """The load differs from what was reported; x is the wrench (6) in sensor axes [N, N·m]."""

    of_payload: ClassVar[bool] = False  # masses that are hung on the tool have it, too
    hangs: ClassVar[bool] = False  # a weight: it pulls along gravity however the tool turns

    def laws_at_positions(self, load_cases: LoadCases) -> tuple[Effect, ...]:
        """Those that it has: in axes of the base, and of the tool."""
        return self.other_laws(load_cases)


class ReadingError(Misreading):
    """The reading differs from the displacement; x is the displacement (3), base axes [m]."""


class Viewpoint(Effect):
    """The instrument stands somewhere of its own: it reads x = R X + t of what is X in base axes.

    Displacements know nothing of it: their axes are part of the file.
    """

    @abstractmethod
    def frames(self, load_cases: LoadCases, values: Array) -> tuple[Array, Array]:
        """(N, 3, 3) rotations R and (N, 3) origins t [m]: base axes as the instrument sees them."""

    @abstractmethod
    def columns(self, load_cases: LoadCases, turned: Array, values: Array) -> Array:
        """(N, 6, P) change of position and turn, instrument axes; `turned` (N, 3) is R X [m]."""


class Mounting(Effect):
    """The target has axes of its own on the tool, R_read = R_tool R(p); positions show nothing."""

    @abstractmethod
    def turned(self, load_cases: LoadCases, values: Array) -> tuple[Array, Array]:
        """(N, 3, 3) axes of the target in those of the tool, and (N, 3, P) how they turn there."""


def scale_of(robot: Robot) -> float:
    """Length of a robot's arm over `REFERENCE_LENGTH`; 1 for what has no length."""
    return arm_length(robot) / REFERENCE_LENGTH or 1.0
