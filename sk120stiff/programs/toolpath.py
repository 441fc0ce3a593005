"""A path as a machining program states it: points, feeds and the tool's axis, in the part's axes.

A reader drives a `Course`: it says where the tool goes, the course cuts arcs and long moves into
points, close enough that chords keep a tolerance, and remembers the line of the file that each
belongs to.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.errors import InputError

MOST_POINTS = 500_000  # of one path
FARTHEST = 1e4  # m from the part's origin
FASTEST = 100.0  # m/s


@dataclass(frozen=True, eq=False)
class ToolPath:
    """N points of the tool's tip, axes of the part.

    Attributes:
        source: The file.
        position: (N, 3) [m].
        axis: (N, 3) unit vector from the tip to the shank, where the file states one.
        feed: (N,) on the way to the point [m/s]; NaN where the file does not say.
        rapid: (N,) is the move to the point a rapid one?
        lines: (N,) line of the file.
        left_out: Words that do not move the tool and are not carried over, with their first line.
        assumed: What the file does not say, and is taken for it: sentences.
    """

    source: Path
    position: Array
    axis: Array | None
    feed: Array
    rapid: Mask
    lines: Index
    left_out: dict[str, int]
    assumed: tuple[str, ...] = ()

    @property
    def count(self) -> int:
        """Number of points N."""
        return len(self.position)


@dataclass
class Course:
    """Points of a path while its file is being read.

    Attributes:
        source: The file, for messages.
        chord: How far a chord of an arc may be off it [m].
        step: Longest distance between points of a feed move [m].
        here: (3,) where the tool is [m]; NaN in an axis that nobody has named.
    """

    source: Path
    chord: float
    step: float = np.inf
    here: Array = field(default_factory=lambda: np.full(3, np.nan))
    position: list[Array] = field(default_factory=list)
    axes: list[Array] = field(default_factory=list)
    feed: list[float] = field(default_factory=list)
    rapid: list[bool] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)
    left_out: dict[str, int] = field(default_factory=dict)
    assumed: tuple[str, ...] = ()

    def leave_out(self, word: str, line: int) -> None:
        """Remember a word that is not carried over."""
        self.left_out.setdefault(word, line)

    def wrong(self, what: str, line: int, remedy: str | None = None) -> InputError:
        """The error of one line."""
        return InputError(what, where=f"{self.source}, line {line}", remedy=remedy)

    def straight(
        self, end: Array, line: int, *, feed: float, rapid: bool, axis: Array | None = None
    ) -> None:
        """Move to `end` (3,); it becomes a point once all its coordinates are known."""
        self._sane(end, feed, line)
        start, known = self.here, bool(np.isfinite(self.here).all())
        self.here = end
        if not np.isfinite(end).all():
            if not rapid:
                raise self.wrong(
                    "the tool feeds before it is known where it stands",
                    line,
                    "Begin with a rapid move that names X, Y and Z.",
                )
            return
        pieces = 1
        if known and not rapid and np.isfinite(self.step):
            parts = float(np.linalg.norm(end - start)) / self.step
            self._room_for(parts, line)
            pieces = max(1, int(np.ceil(parts - 1e-9)))
        share = np.arange(1, pieces + 1)[:, None] / pieces
        points = np.array([end]) if pieces == 1 else start + share * (end - start)
        points[-1] = end
        self._add(points, line, feed, rapid, axis)

    def arc(
        self,
        end: Array,
        centre: Array,
        normal: Array,
        line: int,
        *,
        feed: float,
        turns: int = 1,
        axis: Array | None = None,
    ) -> None:
        """Turn right-handed about `normal` (3,) through `centre` (3,) to `end` (3,)."""
        if not np.isfinite(self.here).all():
            raise self.wrong("an arc begins where the tool is not known to stand", line)
        self._sane(np.concatenate([end, centre]), feed, line)
        points = arc_points(
            self.here, end, centre, normal, turns=turns, chord=self.chord, most=MOST_POINTS
        )
        if isinstance(points, str):
            raise self.wrong(points, line)
        self.here = end
        self._add(points, line, feed, False, axis)

    def _room_for(self, count: float, line: int) -> None:
        if len(self.position) + count > MOST_POINTS:
            raise self.wrong(
                f"the path has more than {MOST_POINTS} points",
                line,
                "Allow a larger --chord or --step, or cut the path into parts.",
            )

    def _sane(self, places: Array, feed: float, line: int) -> None:
        if np.nanmax(np.abs(places), initial=0.0) > FARTHEST:
            raise self.wrong(f"a place more than {FARTHEST:g} m from the origin", line)
        if feed > FASTEST:
            raise self.wrong(f"a feed of {feed:.3g} m/s", line)

    def _add(self, points: Array, line: int, feed: float, rapid: bool, axis: Array | None) -> None:
        count = len(points)
        self._room_for(count, line)
        if axis is not None:
            before = self.axes[-1] if self.axes else axis
            share = np.arange(1, count + 1)[:, None] / count
            between = before + share * (axis - before)
            length = np.linalg.norm(between, axis=1, keepdims=True)
            if length.min() < 1e-6:
                raise self.wrong("the tool's axis turns over within one move", line)
            self.axes += list(between / length)
        self.position += list(points)
        self.feed += [feed] * count
        self.rapid += [rapid] * count
        self.lines += [line] * count

    def path(self) -> ToolPath:
        """What was read.

        Raises:
            InputError: Nothing moved.
        """
        if not self.position:
            raise InputError(
                "the program moves nothing",
                where=str(self.source),
                remedy="It needs moves: G0, G1, G2, G3 in G-code, GOTO in an APT or CLS file.",
            )
        return ToolPath(
            source=self.source,
            position=np.array(self.position),
            axis=np.array(self.axes) if self.axes else None,
            feed=np.array(self.feed),
            rapid=np.array(self.rapid, dtype=bool),
            lines=np.array(self.lines, dtype=np.intp),
            left_out=self.left_out,
            assumed=self.assumed,
        )


WIDEST = np.pi / 2  # of one chord, however coarse the tolerance
UNEQUAL, UNEQUAL_SHARE = 5e-6, 1e-3  # m and of the radius: ends that differ by more share no arc
FAR = 5e-4  # m: ends that differ by more share none either (the rule of LinuxCNC)
WHOLE = 1e-9  # rad: a smaller sweep means a whole turn


def arc_points(
    start: Array,
    end: Array,
    centre: Array,
    normal: Array,
    *,
    turns: int,
    chord: float,
    most: int,
) -> Array | str:
    """(k, 3) points after `start` up to and with `end`, or why there are none.

    The way is right-handed about `normal` (3,); where the ends differ along it the way is a helix.
    A chord over the angle φ is off its arc by r (1 − cos(φ/2)), so φ = 2 acos(1 − chord/r).

    Args:
        centre: (3,) any point of the axis [m].
        turns: How often the end's direction is passed, the last time included.
        chord: Largest distance between arc and chord [m].
        most: Number of points that may not be passed.
    """
    n = normal / np.linalg.norm(normal)
    out, back = start - centre, end - centre
    rise = float((end - start) @ n)
    out, back = out - (out @ n) * n, back - (back @ n) * n
    r, r_end = float(np.linalg.norm(out)), float(np.linalg.norm(back))
    if min(r, r_end) < 1e-9:
        return "the arc has no radius"
    if abs(r - r_end) > FAR or (
        abs(r - r_end) > UNEQUAL and abs(r - r_end) > UNEQUAL_SHARE * max(r, r_end)
    ):
        return (
            f"the arc begins {1e3 * r:.4f} mm from its centre and ends {1e3 * r_end:.4f} mm from it"
        )
    u = out / r
    v = np.cross(n, u)
    sweep = float(np.arctan2(back @ v, back @ u)) % (2.0 * np.pi)
    if sweep < WHOLE or 2.0 * np.pi - sweep < WHOLE:
        sweep = 2.0 * np.pi
    sweep += 2.0 * np.pi * (turns - 1)
    widest = min(WIDEST, 2.0 * float(np.arccos(max(1.0 - chord / r, -1.0))))
    if sweep > most * widest:
        return f"the arc needs more than {most} points for a chord tolerance of {1e6 * chord:g} µm"
    count = max(1, int(np.ceil(sweep / widest - 1e-9)))
    share = np.arange(1, count + 1)[:, None] / count
    radius = r + share * (r_end - r)
    around = np.cos(share * sweep) * u + np.sin(share * sweep) * v
    foot = centre + ((start - centre) @ n) * n
    points = foot + radius * around + share * rise * n
    points[-1] = end
    return np.asarray(points)
