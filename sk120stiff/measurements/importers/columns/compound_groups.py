"""Which composed headers of a table are taken: of one family of columns one group, or none.

Measured values are preferred to commanded ones, and a place that an instrument read to one of the
robot's own; both are said. Where more than one group would fit, or the robot's own pose alone, none
is taken, and `groups_of` names them for whoever has to ask.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from sk120stiff.errors import InputError, listed
from sk120stiff.measurements.importers.columns.compound_headers import (
    COMMANDED,
    MEASURED,
    Compound,
    compound,
    is_hung_mass,
)
from sk120stiff.measurements.importers.columns.orientations import NUMBERED
from sk120stiff.measurements.importers.columns.words import unit_of_header
from sk120stiff.measurements.importers.contract import Meanings

_AXES = {"place": ("x", "y", "z"), "turn": ("qw", "qx", "qy", "qz")}
# Meanings beside which no other place is sought; where the marker sits is not told from the
# robot's own pose, which is asked for.
_PLACES = ("x", "y", "z", "loaded x", "unloaded x", "dx", "dy", "dz", "gauge", "tcp x")
_AXIS = {axis: Compound(axis, None, "", "", instrument=False) for axis in "xyz"}
_STATES = ("", "unloaded ", "loaded ")
COMMANDED_JOINT = f"{COMMANDED} joint"  # begins the meaning of joints that stand beside measured


@dataclass
class Group:
    """Columns of one family, all of one origin.

    Attributes:
        family: ``joint``, ``place``, ``turn``, ``load``, ``time`` or ``temperature``.
        said, of: As of each of its `Compound`.
        columns: Place in the table → what it says.
    """

    family: str
    said: str
    of: str
    columns: dict[int, Compound] = field(default_factory=dict)

    def meanings(self) -> set[str]:
        """Meanings of all its columns."""
        return {each.meaning for each in self.columns.values()}

    @property
    def own(self) -> bool:
        """Is it a place that the robot's controller says?"""
        return self.family == "place" and any(each.own for each in self.columns.values())

    def whole(self, joints: int) -> bool:
        """Does it hold all that belongs together, of a robot with so many joints?"""
        there = self.meanings()
        if self.family == "joint":
            numbers = {int(word[6:]) for word in there}
            every = any(set(range(k, k + joints)) <= numbers for k in (0, 1))
            counted = any(each.counted for each in self.columns.values())
            stated = "joint" in self.of.lower()
            # position[0] of a topic that says nothing of joints: as many as there are joints
            return every and (not counted or stated or len(numbers) == joints > len("xyz"))
        if self.family == "place":
            return any({f"{state}{axis}" for axis in "xyz"} <= there for state in _STATES)
        if self.family == "load":
            return "fx" in there or "fz" in there or "fy" in there
        return set(_AXES.get(self.family, ())) <= there


def groups_of(
    headers: Sequence[str], actuated: tuple[str, ...] = (), *, joints: int | None = None
) -> list[Group]:
    """Groups of composed headers that are whole, in the order of their first columns.

    Args:
        headers: Of the columns, with their units; empty ones are passed over.
        actuated: The robot's joints.
        joints: How many joint columns make a group; as many as are actuated by default.
    """
    plain = {header.lower() for header in headers}
    groups: dict[tuple[str, str, str, int], Group] = {}
    again: dict[tuple[str, str, str], list[str]] = {}  # meanings, of those that come twice both
    for k, header in enumerate(headers):
        known = compound(header, actuated) if header else None
        if known is None:
            continue
        known = _as_subscript(header, known, plain)
        key = known.family, known.said, known.of
        seen = again.setdefault(key, [])
        groups.setdefault((*key, seen.count(known.meaning)), Group(*key)).columns[k] = known
        seen.append(known.meaning)
    count = len(actuated) if joints is None else joints
    return [group for group in groups.values() if group.whole(count)]


def with_compounds(
    headers: Sequence[str],
    meanings: Sequence[tuple[str, float] | None],
    units: Sequence[str | None],
    actuated: tuple[str, ...],
    topic: str | None = None,
    where: str | None = None,
) -> tuple[Meanings, list[str | None], list[str]]:
    """Meanings and units with composed headers, of families that no plain header names.

    Args:
        headers, meanings, units: Of the columns, as plain headers say.
        actuated: The robot's joints.
        topic: Of several places the one to take, as the user told it.
        where: The file, where positions are sought in it.

    Returns:
        Meanings, units, and what was chosen, in sentences.

    Raises:
        InputError: Places beside plain x, y, z of which no word says which were measured.
    """
    out, units_of, notes = list(meanings), list(units), []
    unknown = [h if m is None else "" for h, m in zip(headers, meanings, strict=True)]
    families = _families(meanings)
    groups = groups_of(unknown, actuated)
    if "joint" in families:
        notes += _beside_plain_joints(out, units_of, groups, headers, len(actuated))
    places = [g for g in groups if g.family == "place"]
    groups = [g for g in groups if g.family not in families]
    if "place" in families and places and where is not None:
        found, told = _beside_plain_places(out, places, headers, topic, where)
        groups, notes = groups + found, notes + told
    taken: dict[str, Group] = {}
    for family in sorted({group.family for group in groups}):  # a place before its turn
        rivals = [group for group in groups if group.family == family]
        if family == "turn":
            rivals = [g for g in rivals if _belongs(g, taken.get("place"))]
        if not rivals:
            continue
        group, why = _chosen(rivals, topic, headers)
        if group is None:
            continue
        taken[family] = group
        notes += [why] if why else []
        prefix = f"{MEASURED} " if family in families else ""  # beside plain x, y, z
        for k, each in group.columns.items():
            out[k], units_of[k] = (prefix + each.meaning, 1.0), units_of[k] or each.unit
        for other in rivals:
            if other is not group and family == "joint" and other.said == COMMANDED:
                _set_commanded(out, other)
    for k, known in enumerate(out):  # Temp_C: understood but for the unit
        if known and known[0] == "temperature" and units_of[k] is None:
            more = compound(headers[k], actuated)
            units_of[k] = more.unit if more else None
    hung = [k for k, name in enumerate(headers) if out[k] is None and is_hung_mass(name)]
    if len(hung) == 1 and not _families(out) & {"load"} and units[hung[0]] is None:
        out[hung[0]] = "payload", 1.0
    return out, units_of, notes


def _belongs(turn: Group, place: Group | None) -> bool:
    """Were these axes read with that position, and are not the robot's own?"""
    if place is not None:
        return turn.of == place.of
    return not turn.of or any(each.instrument for each in turn.columns.values())


def _families(meanings: Sequence[tuple[str, float] | None]) -> set[str]:
    """Families that columns of known meaning belong to."""
    there = {known[0] for known in meanings if known}
    plain = {word.removeprefix("measured ") for word in there}
    out = {Compound(word, None, "", "", instrument=False).family for word in plain} - {"place"}
    if plain & set(_PLACES) or {"nominal x", "deviation x"} <= there:
        out.add("place")
    if any(word.startswith("orientation") for word in there):
        out.add("turn")
    if out & {"payload", "load"}:
        out.add("load")
    return out


def _beside_plain_joints(
    out: Meanings,
    units_of: list[str | None],
    groups: list[Group],
    headers: Sequence[str],
    joints: int,
) -> list[str]:
    """Joints beside plain ones: measured ones are taken, else the plain ones; said in sentences.

    Of two that are measured none is taken, and no plain one.
    """
    beside = [g for g in groups if g.family == "joint"]
    measured = [g for g in beside if g.said == MEASURED]
    commanded = [g for g in beside if g.said == COMMANDED]
    at = [k for k, m in enumerate(out) if m and m[0].startswith("joint ")]
    names = [unit_of_header(headers[k])[0].strip().lower() for k in at]
    if measured and joints > len(NUMBERED) and set(NUMBERED) <= set(names) and "q5" not in names:
        at = [k for k, name in zip(at, names, strict=True) if name not in NUMBERED]  # a quaternion
    plain = _span([headers[k] for k in at])
    for group in commanded:
        _set_commanded(out, group)
    if not measured:
        return [
            f"{plain} are taken for measured joints; {_called(group, headers)}, as commanded, are "
            "not."
            for group in commanded
        ]
    for k in at:
        known = out[k]
        number = known[0][6:] if known else ""
        out[k] = (f"{COMMANDED_JOINT} {number}", 1.0) if len(measured) == 1 else None
    if len(measured) > 1:
        return []
    for k, each in measured[0].columns.items():
        out[k], units_of[k] = (each.meaning, 1.0), units_of[k] or each.unit
    others = [*filter(None, [plain]), *(_called(group, headers) for group in commanded)]
    return [
        f"{_called(measured[0], headers)} are taken, as measured joints; {listed(others)}, which "
        "may be commanded, are not."
    ] * bool(others)


def _set_commanded(out: Meanings, group: Group) -> None:
    for k, each in group.columns.items():
        out[k] = f"{COMMANDED_JOINT} {each.meaning[6:]}", 1.0


def _beside_plain_places(
    out: Meanings, places: list[Group], headers: Sequence[str], topic: str | None, where: str
) -> tuple[list[Group], list[str]]:
    """Places beside plain x, y, z: the one that is taken instead of these, and what was chosen.

    Raises:
        InputError: No word says which of them were measured.
    """
    at = {m[0]: k for k, m in reversed(list(enumerate(out))) if m}
    by_word = {f"{MEASURED} {axis}" for axis in "xyz"} <= set(at)
    if not by_word and not set("xyz") <= set(at):
        return [], []
    own = Group("place", "", "", {at[f"{MEASURED} {a}" if by_word else a]: _AXIS[a] for a in "xyz"})
    told = [g for g in places if topic is not None and _is_of(g, topic)]
    if len(told) == 1 and set("xyz") <= told[0].meanings() and not by_word:
        return told, []
    open_ = [g for g in places if g.said != COMMANDED and not g.own]
    measured = [g for g in open_ if g.said == MEASURED and set("xyz") <= g.meanings()]
    if by_word or not open_:
        others = listed([_called(g, headers) for g in places])
        return [], [f"{_called(own, headers)} are taken, as measured positions; {others} are not."]
    if len(measured) == len(open_) == 1:
        return measured, [
            f"{_called(measured[0], headers)} are taken, as measured positions; "
            f"{_called(own, headers)}, as nominal ones, are not."
        ]
    raise InputError(
        f"{listed(shown([own, *open_], headers), 'or')} may be the positions that were measured",
        where=where,
        remedy="Say in their headers which are measured and which are nominal (x measured, "
        "x nominal), name all columns with --columns (x,y,z for those that were measured, of "
        "several markers x1,y1,z1,x2,y2,z2, a dash for one that is not needed), or take the "
        "others out.",
    )


def _is_of(group: Group, topic: str) -> bool:
    """Do its columns stand below a topic, as the user told it?"""
    name = topic.strip("/")
    return group.of.strip("/") == name or group.of.strip("/").startswith(f"{name}/")


def _chosen(
    rivals: list[Group], topic: str | None, headers: Sequence[str]
) -> tuple[Group | None, str]:
    """The one group that is taken, and what is to be said of it; None where it cannot be told."""
    if topic is not None and rivals[0].family in _AXES:
        rivals = [g for g in rivals if _is_of(g, topic)]
        if not rivals:
            return None, ""
    if rivals[0].family == "time":  # clocks of several topics
        return rivals[0], ""
    own = rivals[0].family == "place" and all(g.own or g.said == COMMANDED for g in rivals)
    if topic is None and own:
        return None, ""  # nobody measured it: the controller computed it of the joints
    by_word = [g for g in rivals if g.said == MEASURED and not g.own]
    read = [g for g in rivals if any(c.instrument for c in g.columns.values())]
    why = ""
    if len(rivals) == 1:
        (group,) = rivals
        if group.said == COMMANDED and group.family == "joint":
            why = (
                f"Joint values are commanded ones ({_called(group, headers)}): where the arm "
                "stood, measured ones would say."
            )
        return (group, why) if group.said != COMMANDED or group.family == "joint" else (None, "")
    if len(by_word) == 1 and all(g.said == COMMANDED for g in rivals if g is not by_word[0]):
        others = [_called(g, headers) for g in rivals if g is not by_word[0]]
        return by_word[0], (
            f"{_called(by_word[0], headers)} are taken, as measured; {listed(others)}, as "
            "commanded, are not."
        )
    if len(read) == 1 and rivals[0].family == "place":
        others = [_called(g, headers) for g in rivals if g is not read[0]]
        return read[0], (
            f"{_called(read[0], headers)} are taken, as an instrument read them; "
            f"{listed(others)} are not."
        )
    return None, ""


def _called(group: Group, headers: Sequence[str]) -> str:
    """The first and the last header of a group."""
    return _span([headers[k] for k in group.columns])


def _span(names: Sequence[str]) -> str:
    return f"{names[0]} to {names[-1]}" if len(names) > 1 else "".join(names)


def shown(groups: Sequence[Group], headers: Sequence[str]) -> list[str]:
    """Groups as a message names them, by all their headers."""
    return [", ".join(headers[k] for k in group.columns) for group in groups]


def _as_subscript(header: str, known: Compound, plain: set[str]) -> Compound:
    """x_m is measured, not in metres, where x_n, x_c, x_t or x_d stands beside it."""
    if known.unit != "m" or not header.endswith("m"):
        return known
    others = {f"{header[:-1].lower()}{letter}" for letter in ("c", "n", "t", "d", "cmd", "nom")}
    if not others & plain:
        return known
    return replace(known, unit=None, said=MEASURED)
