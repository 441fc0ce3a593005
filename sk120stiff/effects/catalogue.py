"""The effects that a model may hold and a search considers: a value that adds.

A new effect of the package is one file beside this one and one line here. One from outside is
``CATALOGUE + MyEffect``, given to `explain` or `read_model`; a package that is installed with

.. code-block:: toml

    [project.entry-points."sk120stiff.effects"]
    link_stretch = "my_package.effects:LinkStretch"

has its effects in `CATALOGUE` from the start.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from importlib.metadata import EntryPoint, entry_points
from types import MethodType

from sk120stiff.effects.approach_side import ApproachSide
from sk120stiff.effects.base import Effect
from sk120stiff.effects.closure import ClosureCoupling, ClosureRod
from sk120stiff.effects.force_sensor import (
    ForceBias,
    ForceCrosstalk,
    ForcePoint,
    ForceRotation,
    ForceScale,
)
from sk120stiff.effects.foundation import BaseRocking, BaseSliding
from sk120stiff.effects.gear import FrictionHysteresis, GearHardening, LostMotion
from sk120stiff.effects.geometry import JointOffset, LinkLength, ToolOffset
from sk120stiff.effects.gravity_compensator import GravityCompensator
from sk120stiff.effects.joint_coupling import JointCoupling
from sk120stiff.effects.joint_frame import JointFrame
from sk120stiff.effects.joint_springs import JointSprings
from sk120stiff.effects.joint_tilt import JointTilt
from sk120stiff.effects.link_beam import LinkBending, LinkTorsion
from sk120stiff.effects.link_masses import LinkMasses
from sk120stiff.effects.marker_shift import MarkerShift
from sk120stiff.effects.options import Options
from sk120stiff.effects.payload import Payload
from sk120stiff.effects.payload_mass import PayloadMass
from sk120stiff.effects.places import USUAL_PLACES
from sk120stiff.effects.reading_drift import ReadingDrift
from sk120stiff.effects.target_rotation import TargetRotation
from sk120stiff.effects.thermal_drift import ThermalDrift
from sk120stiff.effects.thermal_growth import ThermalGrowth
from sk120stiff.effects.tool_compliance import ToolCompliance
from sk120stiff.effects.tracker import ReadingRotation, ReadingScale, ZeroOffset
from sk120stiff.effects.tracker_frame import TrackerFrame
from sk120stiff.effects.transmission_error import TransmissionError
from sk120stiff.errors import InputError, meant, warn
from sk120stiff.files import html_table
from sk120stiff.robot import Robot

GROUP = "sk120stiff.effects"  # of the entry points by which packages bring effects
PRINTED = 12  # names that a print of a catalogue has

OWN: tuple[type[Effect], ...] = (
    JointSprings,
    JointTilt,
    LinkBending,
    LinkTorsion,
    BaseRocking,
    BaseSliding,
    ToolCompliance,
    ClosureCoupling,
    ClosureRod,
    GearHardening,
    LostMotion,
    FrictionHysteresis,
    GravityCompensator,
    ForceScale,
    ForceBias,
    ForceRotation,
    ForceCrosstalk,
    ForcePoint,
    ReadingRotation,
    ReadingScale,
    ReadingDrift,
    ZeroOffset,
    JointOffset,
    ToolOffset,
    LinkLength,
    TrackerFrame,
    JointFrame,
    TransmissionError,
    JointCoupling,
    Payload,
    PayloadMass,
    LinkMasses,
    ApproachSide,
    MarkerShift,
    TargetRotation,
    ThermalGrowth,
    ThermalDrift,
)


class Catalogue:
    """Effects by name, in a fixed order; adding to it makes a new one.

    ``CATALOGUE + Mine`` and ``CATALOGUE + (Mine, Other)`` add effects; iteration gives the effects,
    ``catalogue["base_rocking"]`` one of them, ``"base_rocking" in catalogue`` whether it is there.

    Args:
        effects: Classes of effects.

    Raises:
        InputError: Something in it is no effect, or two effects have one name.

    Examples:
        >>> import sk120stiff as sk
        >>> "base_rocking" in sk.CATALOGUE
        True
        >>> sk.Catalogue([sk.CATALOGUE["joint_tilt"], sk.CATALOGUE["lost_motion"]])
        Catalogue(joint_tilt, lost_motion)
    """

    def __init__(self, effects: Iterable[type[Effect]] = ()) -> None:
        self._given = tuple(effects)
        _checked(self._given)

    @cached_property
    def _by_name(self) -> dict[str, type[Effect]]:
        return {kind.name: kind for kind in self._given}

    @property
    def names(self) -> tuple[str, ...]:
        """Public identifiers."""
        return tuple(self._by_name)

    def __iter__(self) -> Iterator[type[Effect]]:
        return iter(self._by_name.values())

    def __len__(self) -> int:
        return len(self._by_name)

    def __contains__(self, item: object) -> bool:
        return item in self._by_name or item in self._by_name.values()

    def __getitem__(self, name: str) -> type[Effect]:
        if name not in self._by_name:
            raise self.unknown(name)
        return self._by_name[name]

    def __add__(self, other: type[Effect] | Iterable[type[Effect]]) -> Catalogue:
        return Catalogue((*self, *((other,) if isinstance(other, type) else other)))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Catalogue) and tuple(self) == tuple(other)

    def __hash__(self) -> int:
        return hash(tuple(self))

    def __repr__(self) -> str:
        shown = self.names[:PRINTED]
        more = len(self.names) - len(shown)
        return f"Catalogue({', '.join([*shown, *([f'and {more} more'] if more else [])])})"

    def _repr_html_(self) -> str:
        """What a notebook shows: every effect, where it acts and its law."""
        columns = {
            "effect": self.names,
            "acts at": [kind.place for kind in self],
            "law": [kind.equation for kind in self],
        }
        return html_table(f"Catalogue of {len(self)} effects", columns)

    def effect(
        self, robot: Robot, name: str, where: str | None = None, options: Options | None = None
    ) -> Effect:
        """One of the effects at one place of a robot; see the function `effect`.

        Examples:
            >>> import sk120stiff as sk
            >>> robot = sk.load_robot("motoman_sk120")
            >>> sk.CATALOGUE.effect(robot, "joint_tilt", "joint_2_l").id
            'joint_tilt:joint_2_l'
        """
        if not isinstance(robot, Robot) or not isinstance(name, str):
            raise InputError(
                f"an effect needs a robot and then its name, not {robot!r} and {name!r}",
                remedy="Write effect(load_robot('ur5e'), 'base_rocking'), for example.",
            )
        kind = self[name]
        places = kind.places(robot)
        if where is None and len(places) == 1:
            where = places[0]
        if where not in places:
            raise self.misplaced(name, where, robot)
        return kind.at(robot, where, options or Options())

    def misplaced(self, name: str, where: str | None, robot: Robot) -> InputError:
        """What to say of an effect that is asked for where it cannot act, or at no place.

        Examples:
            >>> import sk120stiff as sk
            >>> robot = sk.load_robot("motoman_sk120")
            >>> print(sk.CATALOGUE.misplaced("joint_tilt", None, robot).what)
            at which place is the effect 'joint_tilt' meant?
        """
        places = self[name].places(robot)
        if places and not where:
            return InputError(
                f"at which place is the effect {name!r} meant?",
                remedy=f"Write {name}:{places[0]}, for example. It acts at: {', '.join(places)}.",
            )
        at = f" at {where!r}" if where else ""
        return InputError(
            f"the effect {name!r} cannot act{at} on {robot.name}",
            remedy=f"It acts at: {', '.join(places) or 'no place of this robot'}.",
        )

    def unknown(self, name: str) -> InputError:
        """What to say of a name that is no effect's.

        Examples:
            >>> import sk120stiff as sk
            >>> print(sk.CATALOGUE.unknown("base_rockin").what)
            there is no effect 'base_rockin' (did you mean 'base_rocking'?)
        """
        return InputError(
            f"there is no effect {name!r}{meant(name, self.names)}",
            remedy=f"Effects are: {', '.join(self.names)}.",
        )


class _WithInstalled(Catalogue):
    """The package's own effects and those of installed packages, looked up at the first use."""

    @cached_property
    def _by_name(self) -> dict[str, type[Effect]]:
        return {kind.name: kind for kind in with_installed(self._given)}


def with_installed(
    own: Sequence[type[Effect]], points: Iterable[EntryPoint] | None = None
) -> tuple[type[Effect], ...]:
    """Effects with those that entry points bring; one that cannot be had is a warning.

    Warns:
        ToolkitWarning: An entry point cannot be loaded, brings no effect, or one whose name is
            taken.
    """
    found = tuple(own)
    for point in entry_points(group=GROUP) if points is None else points:
        try:
            kind = point.load()
            _checked((*found, kind))
        except Exception as error:  # noqa: BLE001  what others install must not stop the program
            whose = f" of {point.dist.name}" if point.dist else ""
            warn(
                f"the effect {point.name!r}{whose} ({point.value}) is left out: "
                f"{type(error).__name__}: {error}"
            )
        else:
            found = (*found, kind)
    return found


def _missing(kind: type[Effect]) -> list[str]:
    """What of the contract a class does not say."""
    found = sorted(kind.__abstractmethods__)
    if kind.sentence is Effect.sentence and not isinstance(getattr(kind, "says", None), str):
        found.append("says")
    if kind.places == MethodType(Effect.places.__func__, kind):  # type: ignore[attr-defined]
        found += ["places"] * (kind.place not in USUAL_PLACES)
    return found + ["name"] * (not isinstance(getattr(kind, "name", None), str))


def _checked(kinds: Sequence[type[Effect]]) -> None:
    """Refuse what is no effect, and names that stand twice."""
    seen: dict[str, type[Effect]] = {}
    for kind in kinds:
        if not (isinstance(kind, type) and issubclass(kind, Effect)):
            raise InputError(
                f"{kind!r} is no effect",
                remedy="Give a class derived from Elastic, Geometric, Imposed, Weighing, "
                "LoadError, ReadingError, Viewpoint or Mounting of sk120stiff.effects.",
            )
        missing = _missing(kind)
        if missing:
            raise InputError(
                f"the effect {kind.__name__} lacks {', '.join(missing)}",
                remedy="See the contract in sk120stiff.effects.base.",
            )
        if kind.name in seen:
            raise InputError(
                f"two effects have the name {kind.name!r}: {_where(seen[kind.name])} and "
                f"{_where(kind)}",
                remedy="Give yours another name.",
            )
        seen[kind.name] = kind


def _where(kind: type[Effect]) -> str:
    return f"{kind.__module__}.{kind.__qualname__}"


CATALOGUE: Catalogue = _WithInstalled(OWN)


def effect(
    robot: Robot,
    name: str,
    where: str | None = None,
    *,
    poses: Sequence[str] = (),
    timed: bool = False,
    breaks: Sequence[float] = (),
    series: Sequence[str] = (),
    stations: Sequence[str] = ("",),
    thermal: bool = False,
    catalogue: Catalogue = CATALOGUE,
) -> Effect:
    """One effect at one place of a robot.

    Args:
        robot: The robot that it acts on.
        name: Public identifier, e.g. ``"base_rocking"``.
        where: Joint, link or instrument; may be left out where there is only one.
        poses: Poses of the experiment, for `zero_offset`.
        timed: The experiment has times, for `reading_drift`.
        breaks: Torques [N·m] at which a gear changes its stiffness, for `gear_hardening`.
        series: Series of the experiment, for `marker_shift`.
        stations: Where the tracker stood, for `tracker_frame`.
        thermal: The experiment has temperatures, for `thermal_growth`.
        catalogue: The effects that there are.

    Raises:
        InputError: No such effect, or it cannot act there; what exists is listed.

    Examples:
        >>> import sk120stiff as sk
        >>> robot = sk.load_robot("motoman_sk120")
        >>> sk.effect(robot, "base_rocking").id
        'base_rocking:base_link'
    """
    return catalogue.effect(
        robot,
        name,
        where,
        Options(tuple(poses), timed, tuple(breaks), tuple(series), tuple(stations), thermal),
    )


def all_effects(
    robot: Robot,
    *,
    poses: Sequence[str] = (),
    timed: bool = False,
    series: Sequence[str] = (),
    stations: Sequence[str] = ("",),
    thermal: bool = False,
    absolute: bool = False,
    catalogue: Catalogue = CATALOGUE,
) -> tuple[Effect, ...]:
    """Every effect of the catalogue at every place of a robot where it can act.

    Those that positions alone show are left out unless readings are `absolute`.
    """
    told = Options(
        tuple(poses), timed, series=tuple(series), stations=tuple(stations), thermal=thermal,
        rotations=absolute,
    )  # fmt: skip
    return tuple(
        kind.at(robot, where, told)
        for kind in catalogue
        if absolute or not kind.only_absolute
        for where in kind.places(robot)
    )
