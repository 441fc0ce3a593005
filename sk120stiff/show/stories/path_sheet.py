"""One sheet for a loaded path: before and after, what moves the tool, and what was measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from sk120stiff.arrays import Array, largest, rms
from sk120stiff.model import Share
from sk120stiff.show.figures.budget import budget_bars
from sk120stiff.show.figures.path_error import error_along, exaggeration, path_map
from sk120stiff.show.report import (
    Block,
    Items,
    KeyFigure,
    KeyFigures,
    Note,
    Picture,
    Report,
    Section,
    Table,
)
from sk120stiff.show.wording import counted, um, um_or_less
from sk120stiff.workspace import Returned

LISTED = 8  # points in the table of the worst
SMALL = 1e-3  # of the largest share: too small to draw


@dataclass(frozen=True, eq=False)
class PathSheet:
    """What the sheet shows of N points, axes of the path.

    Attributes:
        path, robot: Their names.
        lines: (N,) line of the path's file.
        position: (N, 3) where the tool should stand [m].
        before, after: (N, 3) how far off it stands, predicted [m]; NaN: nowhere.
        std: (N,) standard distance of a prediction [m]; None: nothing is stored.
        uncertainty: The same in words.
        shares: What each effect brings, uncorrected.
        measured: What came back, run by run.
        facts: Sentences about what was assumed.
        reproducibility: As in every report.
    """

    path: str
    robot: str
    lines: Sequence[int]
    position: Array
    before: Array
    after: Array
    std: Array | None
    uncertainty: Sequence[str]
    shares: Sequence[Share]
    measured: Sequence[Returned]
    facts: Sequence[str]
    reproducibility: Mapping[str, str] = field(default_factory=dict)

    @property
    def off(self) -> dict[str, Array]:
        """Run → (N,) predicted distance [m]."""
        return {
            "before": np.asarray(np.linalg.norm(self.before, axis=1)),
            "after": np.asarray(np.linalg.norm(self.after, axis=1)),
        }

    @property
    def read(self) -> dict[str, Array]:
        """Run → (N,) measured distance [m]."""
        return {each.run: np.asarray(np.linalg.norm(each.away, axis=1)) for each in self.measured}

    def report(self) -> Report:
        """The page; its print is the PDF."""
        sections = [
            Section("Before and after", self._answer()),
            Section("Where it is worst", self._worst()),
            *([Section("What moves the tool", self._budget())] if self.shares else []),
            *([Section("As measured", self._measured())] if self.measured else []),
            Section("What was assumed", [Items(list(self.facts))]),
        ]
        return Report(
            f"{self.path}: before and after compensation",
            sections,
            subtitle=f"{self.robot}, {counted(len(self.lines), 'point')}",
            lead=self._lead(),
            reproducibility=self.reproducibility,
        )

    def _lead(self) -> str:
        before, after = (self.off[run] for run in ("before", "after"))
        if not np.isfinite(before).any():
            return "The springs of the model cannot hold this load at any point."
        worst = int(np.nanargmax(before))
        said = (
            f"Uncorrected, the loaded tool stands {um(rms(before))} µm (rms) off its path, most "
            f"at line {self.lines[worst]}: {um(float(before[worst]))} µm. "
        )
        if self.std is None:
            said += (
                f"Corrected, the model sees {um_or_less(rms(after))} µm; how far off the tool "
                "stands in truth is not known."
            )
        else:
            said += f"Corrected, {um_or_less(rms(after))} µm ± {um(rms(self.std))} µm are expected."
        for run, away in self.read.items():
            said += f" Measured {run} correction: {um(rms(away))} µm."
        return said

    def _answer(self) -> list[Block]:
        before, after = (self.off[run] for run in ("before", "after"))
        figures = [
            KeyFigure("before, predicted", um(rms(before)), "µm", f"at most {um(largest(before))}"),
            KeyFigure("after, predicted", um_or_less(rms(after)), "µm",
                      f"at most {um_or_less(largest(after))}"),
            KeyFigure(
                "± of a prediction", "–" if self.std is None else um(rms(self.std)), "µm",
                "one standard distance" if self.std is not None else "unknown, see below",
            ),
        ]  # fmt: skip
        figures += [
            KeyFigure(f"{run}, measured", um(rms(away)), "µm", f"at most {um(largest(away))}")
            for run, away in self.read.items()
        ]
        length = np.concatenate(
            [[0.0], np.cumsum(np.linalg.norm(np.diff(self.position, axis=0), axis=1))]
        )
        return [
            KeyFigures(figures),
            Picture(
                lambda: error_along(length, self.off, self.std, self.read),
                alt=f"Distance of the loaded tool from its target: {um(rms(before))} µm before,"
                f" {um_or_less(rms(after))} µm after compensation (rms).",
                caption="How far the loaded tool stands off its target, along the path.",
            ),
            *([Note(" ".join(self.uncertainty), "caution" if self.std is None else "note")]
              if self.uncertainty else []),
        ]  # fmt: skip

    def _worst(self) -> list[Block]:
        before, after = (self.off[run] for run in ("before", "after"))
        known = np.flatnonzero(np.isfinite(before))
        if not len(known):
            return ["No point has an equilibrium."]
        order: list[int] = []  # the worst of each line of the file, where an arc is many points
        for k in known[np.argsort(-before[known], kind="stable")]:
            if self.lines[k] not in [self.lines[other] for other in order]:
                order.append(int(k))
        order = order[:LISTED]
        header = ["line", "x", "y", "z", "before", "dx", "dy", "dz", "after"]
        units = ["", "mm", "mm", "mm", *["µm"] * 5]
        columns = [1e6 * before, 1e6 * self.before, 1e6 * after]
        if self.std is not None:
            header, units = [*header, "±"], [*units, "µm"]
            columns.append(1e6 * self.std)
        rows = [
            (
                str(self.lines[k]),
                *(int(x) for x in np.round(1e3 * self.position[k])),
                *(float(x) for part in columns for x in np.atleast_1d(np.round(part[k], 3))),
            )
            for k in order
        ]
        worst = order[0]
        factor = exaggeration(self.position[known], self.before[known])
        return [
            Picture(
                lambda: path_map(
                    self.position[known], self.before[known], int(np.flatnonzero(known == worst)[0])
                ),
                alt=f"Map of the path with its errors; the worst point is at line "
                f"{self.lines[worst]}, {um(float(before[worst]))} µm.",
                caption=f"The path in its own axes, coloured by the uncorrected error; red lines "
                f"show its direction, {factor:,.0f} times as long. The ring marks the worst point.",
            ),
            Table(header, rows, "The worst point of each line of the path's file, largest first.",
                  units=units, digits=3),
        ]  # fmt: skip

    def _budget(self) -> list[Block]:
        most = self.shares[0].rms
        shown = [share for share in self.shares if share.rms > SMALL * most]
        if not shown:
            return ["No effect of the model moves the tool."]
        size = np.sqrt(3.0) * 1e6  # from rms per axis to rms distance
        told = ", ".join(f"{s.name} {size * s.rms:.3g} µm" for s in shown)
        return [
            "Uncorrected, rms over the points. The parts add as vectors: they need not add up.",
            Picture(
                lambda: budget_bars(
                    [s.name for s in shown],
                    np.array([size * s.rms for s in shown]),
                    np.array([size * (s.std or 0.0) for s in shown]),
                    label="µm rms along the path, ± one standard error",
                ),
                alt=f"Bars of {counted(len(shown), 'share')}: {told}.",
                caption="What each effect of the model moves the loaded tool by.",
            ),
            Table(
                ["what yields", "moves", "±"],
                [(s.name, size * s.rms, None if s.std is None else size * s.std) for s in shown],
                "Rms distance along the path, with its standard error where one is stored.",
                units=["", "µm", "µm"],
                digits=3,
            ),
        ]

    def _measured(self) -> list[Block]:
        predicted = {"before": self.before, "after": self.after}
        rows = [
            (
                each.run,
                int(each.seen.sum()),
                1e6 * each.rms,
                round(1e6 * rms(self.off[each.run][each.seen]), 3),
                1e6 * each.apart(predicted[each.run]),
                ", ".join(f"{1e6 * x:+.0f}" for x in each.constant).replace("-", "−"),
                1e6 * each.about_constant,
            )
            for each in self.measured
        ]
        said: list[Block] = [
            Table(
                ["run", "points", "measured", "predicted", "apart", "constant part (x, y, z)",
                 "without it"],
                rows,
                "Rms distances of the loaded tool from its target. Apart: rms of measured minus "
                "predicted. A constant part is what a shifted part or tracker frame would make.",
                units=["", "", "µm", "µm", "µm", "µm", "µm"],
                digits=3,
            )
        ]  # fmt: skip
        if set(self.read) == {"before", "after"}:
            both = np.isfinite(self.read["before"]) & np.isfinite(self.read["after"])
            share = 1.0 - rms(self.read["after"][both]) / rms(self.read["before"][both])
            return [
                f"Compensation took away {100 * share:.0f} % of the measured error."
                if share >= 0.0
                else f"Compensation made the measured error {-100 * share:.0f} % larger.",
                *said,
            ]
        return said
