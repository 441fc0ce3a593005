"""The search for slips of the pen: correct, refit what a passive arm could do, compare.

Slips are told with confidence only. A correction must leave less than 1/`CLEARER` of the mean
square that the file as it stands leaves, more than luck explains, and it must end in a sound fit.
On sound readings no correction comes near: turning a sign or moving a row makes a fit worse.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.data_checks.correction import Correction, half_turn
from sk120stiff.data_checks.from_a_row_on import from_a_row_on
from sk120stiff.data_checks.part_rows import part_of_the_rows
from sk120stiff.data_checks.part_words import correction_of, headers_of
from sk120stiff.data_checks.passive import Passive, passive
from sk120stiff.data_checks.sheet import Sheet, sheet_of
from sk120stiff.data_checks.slips import floor, floors, of_axes, of_joints, of_rows, sign_of
from sk120stiff.data_checks.turned_axes import by_any_angle, quarter_turns, two_zeros
from sk120stiff.errors import ToolkitError
from sk120stiff.measurements import Measurements
from sk120stiff.robot import Robot

CLEARER = 1.7  # times as much that is left without the correction
CLEARER_TOGETHER = 2.5  # the same for several joints at once: more is tried, so more is asked
LUCK = 30.0  # twice the log-likelihood that the best of a hundred useless corrections never gains
SOUND = 0.75  # share explained once readings are right; what no passive arm does costs some
DOUBTFUL = 0.97  # share below which several joints are tried at once
NEXT_TO = 1.5  # times as much left by another correction that is told beside the best one
ALIKE = 1.05  # times as much left by a turn of the base, which is told rather than one of a joint
STEPS = 3  # slips told of one file
SPARE = 6  # numbers beyond the compliances that it takes to judge a fit
CONVENTION = 8  # joints at most whose signs are tried together: 2ⁿ choices
MOST = 0.9999  # share that is told at most: no arm explains everything
MANY = 300  # readings that suffice to rank many corrections at once


@dataclass(frozen=True)
class Slip:
    """What was written down wrongly, and what mends it.

    Attributes:
        corrections: One or more, to be made together.
        before, after: Share of the readings' squares that a passive arm explains without and with
            them.
        rival: Another correction that explains nearly as much, or None.
    """

    corrections: tuple[Correction, ...]
    before: float
    after: float
    rival: Correction | None = None

    @property
    def said(self) -> str:
        """What looks wrong, without a full stop."""
        what = "; ".join(correction.said for correction in self.corrections)
        return (
            f"{what} (of the readings' squares the arm's springs and bearings could then explain "
            f"{100.0 * min(self.after, MOST):.4g} %, as they stand {100.0 * self.before:.3g} %)"
        )

    @property
    def remedy(self) -> str:
        """The edits, as sentences."""
        text = " ".join(correction.remedy for correction in self.corrections)
        text += half_turn(self.corrections)
        if self.rival is not None:
            text += f" Nearly as good: {self.rival.said}. {self.rival.remedy}"
        return text


@dataclass(frozen=True)
class Tried:
    """One correction, and what a passive arm leaves of the mended sheet.

    Attributes:
        corrections: What is mended.
        sheet: The mended sheet.
        found: What a passive arm does with it.
        unmended: What it leaves of the same rows without the last correction, where that does
            without some of them [m²]; a move of rows must not win by what it leaves out.
    """

    corrections: tuple[Correction, ...]
    sheet: Sheet
    found: Passive
    unmended: float | None = None

    @property
    def left(self) -> float:
        """Mean square left, as if no axis had been stretched [m²]."""
        return self.found.left * float(np.exp(-2.0 * self.sheet.stretch))


def find_slip(robot: Robot, measurements: Measurements) -> Slip | None:
    """What looks written down wrongly in readings of a robot, or None.

    Args:
        robot: The rigid robot. Springs are not asked for: they are refitted for every correction.
        measurements: Readings; masked ones are left out.
    """
    sheet, lines = sheet_of(robot, measurements), measurements.line
    if sheet is None or not sheet.exists() or not sheet.moves:
        return None
    stated = measurements.noise.sigma
    start = as_it_stands(sheet)
    now, rival = _one_by_one(start, enough=(1.5 * stated) ** 2 if stated is not None else 0.0)
    if now.found.share < DOUBTFUL and robot.n <= CONVENTION:
        together = _joints_together(start)
        if together is not None and _clearly(now, together, CLEARER):
            now, rival = together, None
    axes, other = _turned(start)
    if axes is not None and _clearly(now, axes, CLEARER):
        now, rival = axes, other
    if now.found.share < DOUBTFUL and len(sheet.kept) == len(lines):
        drives = _drives(sheet.columns(), sheet.told, robot.n)
        below = None if now.corrections else from_a_row_on(sheet, lines, drives)
        if below is not None:
            mended = Tried((below.correction,), sheet, below.found)
            if _clearly(start, mended, CLEARER_TOGETHER):
                now = mended
        part = _in_a_part(start, measurements, drives)
        if part is not None and _clearly(now, part, CLEARER_TOGETHER):
            now, rival = part, None
    if not now.corrections or now.found.share < SOUND:
        return None
    return Slip(now.corrections, start.found.share, now.found.share, rival)


def _in_a_part(start: Tried, measurements: Measurements, drives: int | None) -> Tried | None:
    """Another unit or sign in a part of the rows; None where none is worth having looked for it.

    Of single gauges along directions of their own it is not looked for: the words are of axes.
    """
    if measurements.directions is not None:
        return None
    part = part_of_the_rows(start.sheet, drives)
    if part is None or part.found.left <= 0.0:
        return None
    gained = start.sheet.told * np.log(start.left / part.found.left)
    if gained < LUCK + part.price:
        return None
    headers = headers_of(measurements.path)
    correction = correction_of(part, start.sheet, measurements.line, headers)
    return None if correction is None else Tried((correction,), start.sheet, part.found)


def _one_by_one(start: Tried, enough: float) -> tuple[Tried, Correction | None]:
    """One correction after the other, as long as each is clearly needed; and the last one's rival.

    What leaves no more than `enough` [m²] leaves what the instrument leaves.
    """
    now, rival = start, None
    for _ in range(STEPS):
        if now.left < enough:
            break
        tried = sorted(_tried(now, _single(now.sheet)), key=lambda each: each.left)
        better = [each for each in tried if _clearly(now, each, CLEARER)]
        if not better:
            break
        now = better[0]
        near = [each for each in better[1:] if each.left < NEXT_TO * now.left]
        rival = near[0].corrections[-1] if near else None
    return now, rival


def as_it_stands(sheet: Sheet) -> Tried:
    """The sheet without a correction."""
    return Tried((), sheet, passive(_columns(sheet, sheet.told), sheet.measured))


def _single(sheet: Sheet) -> Iterator[Correction]:
    yield from of_axes(sheet)
    yield from of_joints(sheet)
    yield from of_rows(sheet)


def _tried(now: Tried, corrections: Iterable[Correction]) -> Iterator[Tried]:
    told = now.sheet.told
    known = _columns(now.sheet, told)
    for correction in corrections:
        sheet = correction.mend(now.sheet)
        own = known
        if not sheet.same_columns(now.sheet):
            if not sheet.exists():
                continue
            try:
                own = _columns(sheet, told)
            except ToolkitError:
                continue  # the arm cannot stand so
        unmended = None
        if sheet.kept is not now.sheet.kept:
            same = sheet.kept[now.sheet.kept]
            unmended = passive(known[same], now.sheet.measured[same]).left
        found = passive(own, sheet.measured)
        yield Tried((*now.corrections, correction), sheet, found, unmended)


def _columns(sheet: Sheet, told: int) -> Array:
    """Unit displacements; where little was told only of the drives, or they would explain all."""
    columns = sheet.columns()
    return columns[:, :, : _drives(columns, told, sheet.robot.n)]


def _drives(columns: Array, told: int, n: int) -> int | None:
    """How many of the unit compliances are asked for: all (None), or those of the drives."""
    return None if told >= columns.shape[2] + SPARE else n


def _clearly(now: Tried, other: Tried, ratio: float) -> bool:
    """Is it better by more than luck and by more than laws that are not quite right?

    The drives' compliances explain as many numbers of any readings: those beyond them tell.
    """
    told = min(now.sheet.told, other.sheet.told, now.found.count, other.found.count)
    spare = told - now.sheet.robot.n
    if spare <= 0:
        return False
    before = now.left
    if other.unmended is not None:
        before = min(before, other.unmended * float(np.exp(-2.0 * now.sheet.stretch)))
    if other.left <= 0.0:
        return before > 0.0
    gained = np.log(max(before, 1e-300) / other.left)
    return bool(gained > np.log(ratio) and spare * gained > LUCK)


def _turned(start: Tried) -> tuple[Tried | None, Correction | None]:
    """Axes or a zero that are turned, and what does nearly as well; None: nothing tells of it."""
    corrections = list(quarter_turns(start.sheet))
    if start.found.share < DOUBTFUL:
        few = as_it_stands(start.sheet.thinned(MANY))

        def left(correction: Correction) -> float:
            found = _all_of((correction,), few.sheet)
            return np.inf if found is None else found.left

        corrections += by_any_angle(few.sheet, left)
    tried = _tried(start, corrections)
    good = [each for each in tried if _clearly(start, each, CLEARER_TOGETHER)]
    if not good:
        return None, None
    least = min(each.left for each in good)
    best = next(each for each in good if each.left < ALIKE * least)
    said = best.corrections[-1].said
    near = [each.corrections[-1] for each in good if each.left < NEXT_TO * best.left]
    return best, next((each for each in near if each.said != said), None)


def _joints_together(start: Tried) -> Tried | None:
    """Signs of several joints, one joint against the floor, two zeros: a controller's convention.

    Of the conventions that do about as well, the one that changes least; None: none is needed.
    """
    few = as_it_stands(start.sheet.thinned(MANY))
    n = few.sheet.robot.n
    tried = []
    for flips in product((False, True), repeat=n):
        signs = [sign_of(few.sheet, k) for k in range(n) if flips[k]]
        bent = [floor(few.sheet, *each) for each in floors(few.sheet) if not flips[each[0]]]
        conventions = [tuple(signs), *((one, *signs) for one in bent)]
        # One correction alone was tried before.
        tried += [_all_of(each, few.sheet) for each in conventions if len(each) > 1]
    # An arm that stands upright at zero, and one that lies stretched there, differ at two joints.
    tried += [_all_of(pair, few.sheet) for pair in two_zeros(few.sheet)]
    good = [each for each in tried if each is not None and _clearly(few, each, CLEARER_TOGETHER)]
    best = min((each.left for each in good), default=0.0)
    near = [each for each in good if each.left < 1.1 * best]
    if not near:
        return None
    chosen = min(near, key=lambda each: (len(each.corrections), each.left))
    whole = _all_of(chosen.corrections, start.sheet)
    return whole if whole is not None and _clearly(start, whole, CLEARER_TOGETHER) else None


def _all_of(corrections: tuple[Correction, ...], sheet: Sheet) -> Tried | None:
    """The sheet with all corrections, in their order; None if the arm cannot stand so."""
    told = sheet.told
    for correction in corrections:
        sheet = correction.mend(sheet)
    if not sheet.exists():
        return None
    return Tried(corrections, sheet, passive(_columns(sheet, told), sheet.measured))
