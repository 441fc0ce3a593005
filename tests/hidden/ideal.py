"""What could be reached: an observer who knows the generator's physics, its noise and its sizes
decides which cause is at work. `python -m tests.hidden.ideal FOLDER ... [--draws 200]`.

Reads level and seed from truth/NAME.json and builds the case anew; no reading and no answer is
opened. Of several hidden causes each is looked for while the others are known, their sizes free.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from .answers import Answer, identity
from .generator.build import rebuild
from .generator.case import Case
from .generator.draw import choices
from .generator.noise import Noise
from .generator.rotations import Array
from .generator.signature import orthonormal, view
from .generator.usual import unusual
from .generator.world import Cause
from .judge import mark
from .observer import LENIENT, STRICT, Candidates, Law, Whole, decide, posterior
from .score import level_of

STRENGTHS = {"L1": (26.0, 80.0), "L2": (8.0, 25.0), "L3": (4.0, 8.0), "L4": (8.0, 16.0),
             "L6": (12.0, 45.0), "L9": (10.0, 60.0), "L1.plans": (26.0, 80.0),
             "L2.plans": (8.0, 25.0)}  # fmt: skip
BROAD = (2.0, 200.0)
# What is known of sizes. broad: how they relate in the generator, strengths of 2 to 200, each
# order of magnitude as likely; known: the strengths of the level; loose: signs alone, 2 to 200.
SIZES = ("broad", "known", "loose")
DRAWN = 400  # causes of a candidate whose mean and scatter stand for its distribution
OPTIONS = {"gear_hardening": 6, "link_bending": 2, "link_torsion": 2}  # knees and tapers tried
# share among a candidate's ways, mean and spread of the change, the cause itself
Way = tuple[float, Array, Array, Cause | None]


class Bench:
    """One case, whitened, with all that every candidate may look like."""

    def __init__(self, case: Case) -> None:
        noise = Whole(**{f.name: getattr(case.noise, f.name) for f in fields(Noise)})
        self.case = case
        self.seen = view(case.world.with_causes(), case.train, noise)
        self.start = self.seen.world.displacement(case.train, iterations=1)
        self._known: dict[str, Array] = {}

    def columns(self, cause: Cause) -> Array:
        """First-order changes (n, parameters), base springs projected out."""
        out = []
        for part in cause.parts():
            key = f"{part.name} {part}"
            if key not in self._known:
                moved = self.seen.world.with_causes(part).displacement(
                    self.case.train, iterations=1
                )
                change = self.seen.whiten(moved - self.start)
                self._known[key] = self.seen.beyond_base(change)
            out.append(self._known[key])
        return np.array(out).T

    def constants(self) -> Array:
        """A constant for every pose, each axis for itself: what zeros of its own look like."""
        pose = self.case.train.pose
        own = (pose[:, None] == np.unique(pose)[None, :]).astype(float)
        out = self.seen.white @ np.kron(own, np.eye(3))
        return out - self.seen.base @ (self.seen.base.T @ out)

    def without(self, others: Sequence[Cause]) -> Array:
        """(n, n): takes away what known causes of unknown size can bring. Zeros of every pose's
        own are further noise of known size, whitened too."""
        out = np.eye(len(self.seen.white))
        for cause in others:
            if cause.name == "zero_offset":
                left, values, _ = np.linalg.svd(self.constants(), full_matrices=False)
                gain = 1.0 / np.hypot(1.0, cause.size("rms") * values)
                out = out - (left * (1.0 - gain)) @ left.T
        known = [out @ self.columns(c) for c in others if c.name != "zero_offset"]
        if known:
            basis = orthonormal(np.concatenate(known, axis=1))
            out = out - basis @ (basis.T @ out)
        return out

    def candidates(self, sizes: str) -> Candidates:
        """Every catalogue cause at every place."""
        low, high = STRENGTHS[self.case.level] if sizes == "known" else BROAD
        strengths = np.geomspace(low, high, int(np.log(high / low) / 0.25) + 2)
        hidden = {(h.cause.name, h.cause.where): h.cause for h in self.case.hidden}
        rng = np.random.default_rng(0)
        out: Candidates = {}
        for choice in choices(self.case.arm):
            drawn = [choice.make(rng) for _ in range(DRAWN)]
            if choice.name == "zero_offset":
                ways = self._zeros()
            else:
                truth = hidden.get((choice.name, choice.where))
                ways = self._ways(drawn, truth, sizes == "loose")
            laws = [law for w in ways if (law := self._law(w, strengths, sizes)).strengths.size]
            if laws:
                out.setdefault(identity(choice.name, choice.where), laws)
        return out

    def _zeros(self) -> list[Way]:
        """None where a pose is read once or all its readings share one zero: that is noise."""
        rows = self.case.train
        if self.case.noise.shared_zero or len(np.unique(rows.pose)) == rows.count:
            return []
        columns = self.constants()
        return [(1.0, np.zeros(len(columns)), columns, None)]

    def _ways(self, drawn: Sequence[Cause], truth: Cause | None, loose: bool) -> list[Way]:
        """One way for every set of parameters that is drawn together, and for some options."""
        together = loose and drawn[0].name != "gear_hardening"
        every = tuple(sorted({key for cause in drawn for key in cause.sizes}))
        kinds: dict[tuple[str, ...], list[Cause]] = {}
        for cause in drawn:
            kinds.setdefault(every if together else tuple(sorted(cause.sizes)), []).append(cause)
        out: list[Way] = []
        for keys, causes in kinds.items():
            table = np.array([[cause.size(key) for key in keys] for cause in causes])
            scale = np.sqrt(np.mean(table**2, axis=0))
            table = table / scale
            mean, scatter = table.mean(axis=0), np.atleast_2d(np.cov(table.T))
            if loose:  # as wide as a half-normal distribution where there is one sign alone
                signed = (table < 0.0).any(axis=0)
                mean = np.where(signed, 0.0, np.sqrt(2.0 / np.pi))
                scatter = np.diag(1.0 - mean**2)
            root = np.linalg.cholesky(scatter + 1e-6 * np.eye(len(keys)))
            some = causes[: 1 if "cubic" in keys else OPTIONS.get(causes[0].name, 1)]
            if truth is not None and truth.options and set(truth.sizes) == set(keys):
                some = [*some, truth]
            for one in some:
                sized = replace(one, sizes=dict(zip(keys, scale.tolist(), strict=True)))
                columns = self.columns(sized)
                share = len(causes) / len(some) / DRAWN
                out.append((share, columns @ mean, columns @ root, sized))
        return out

    def _law(self, way: Way, strengths: Array, sizes: str) -> Law:
        """Scaled to strength one; strengths that need a size beyond belief are left out."""
        share, mean, spread, sized = way
        norm = float(np.sqrt(mean @ mean + np.sum(spread**2)))
        kept = strengths if norm > 1e-9 else strengths[:0]
        if sizes != "loose" and sized is not None:
            kept = np.array([
                a for a in kept if 1 / 80 <= a / norm <= 8.0
                and not unusual(sized.scaled(0.5 * a / norm), self.case.arm)
            ])  # fmt: skip
        norm = max(norm, 1e-9)
        return Law(mean / norm, spread / norm, kept, share / len(strengths))


def case_line(path: Path, given: argparse.Namespace) -> dict[str, Any]:
    """Shares over the draws of one case."""
    truth = json.loads(path.read_text(encoding="utf-8"))
    case = rebuild(truth["level"], truth["seed"])
    if not isinstance(case, Case):
        raise TypeError(f"{path.stem} is no case of displacements")
    bench = Bench(case)
    own = {identity(h.cause.name, h.cause.where): h.cause for h in case.hidden}
    rng = np.random.default_rng((given.seed, *truth["seed"]))
    noise = rng.normal(size=(len(bench.seen.white), given.draws))
    said: dict[str, list[list[frozenset[str]]]] = {}  # view -> groups of every draw
    for sizes in SIZES:
        candidates = bench.candidates(sizes)
        for name, cause in own.items():
            cut = bench.without([c for other, c in own.items() if other != name])
            left = {
                other: [law.through(cut) for law in laws]
                for other, laws in candidates.items()
                if other == name or other not in own
            }
            seen = (cut @ bench.columns(cause).sum(axis=1))[:, None] + noise
            looks = [(sizes, seen, STRICT)]
            if sizes == "broad":
                looks += [("lenient", seen, LENIENT), ("alarm", noise, STRICT)]
                looks += [("lenient alarm", noise, LENIENT)]
            for look, data, allowed in looks:
                draws = said.setdefault(look, [[] for _ in range(given.draws)])
                for groups, chances in zip(draws, posterior(left, data, given.none).T, strict=True):
                    groups += [decide(list(left), chances, allowed)]
    out: dict[str, Any] = {
        "case": path.stem, "level": level_of(truth), "robot": truth["robot"],
        "hidden": " + ".join(own), "strength": [e["visibility"] for e in truth["effects"]],
    }  # fmt: skip
    for look, draws in said.items():
        told = [[group for group in groups if group] for groups in draws]
        verdict = "ambiguous" if out["level"] == "L4" else "named"  # a set brings next poses
        marks = [mark(truth, Answer(verdict, each, next_poses=True))[:2] for each in told]
        out[look] = float(np.mean([right for right, _ in marks]))
        if look.endswith("alarm"):
            out[look] = sum(map(len, told)) / given.draws / len(own)
        elif look == "broad":
            lengths = np.array([len(group) for groups in draws for group in groups])
            out["wrong"] = float(np.mean([wrong > 0 for _, wrong in marks]))
            out["alone"], out["none"] = float(np.mean(lengths == 1)), float(np.mean(lengths == 0))
            out["names"] = float(lengths[lengths > 0].mean()) if lengths.any() else float("nan")
    return out


SHOWN = ("broad", "alone", "none", "wrong", "names", "known", "loose", "lenient", "alarm",
         "lenient alarm")  # fmt: skip


def table(lines: Sequence[dict[str, Any]]) -> str:
    """One row for every level, as Markdown: percentages, and names in an answer."""
    out = [f"| level | cases | right | {' | '.join(SHOWN[1:])} |", "|---" * (len(SHOWN) + 2) + "|"]
    for level in sorted({line["level"] for line in lines}):
        own = [line for line in lines if line["level"] == level]
        right = np.array([line["broad"] for line in own])
        error = right.std(ddof=1) / np.sqrt(len(own)) if len(own) > 1 else float("nan")
        cells = [f"{100 * right.mean():.1f} ± {100 * error:.1f}"]
        for key in SHOWN[1:]:
            mean = float(np.nanmean([line[key] for line in own]))
            cells.append(f"{mean:.2f}" if key == "names" else f"{100 * mean:.1f}")
        out.append(f"| {level} | {len(own)} | {' | '.join(cells)} |")
    return "\n".join(out)


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--draws", type=int, default=200, help="of the noise, for every case")
    parser.add_argument("--none", type=float, default=0.5, help="prior that nothing is hidden")
    parser.add_argument("--levels", default=",".join(STRENGTHS), help="only these")
    parser.add_argument("--seed", type=int, default=1, help="of the noise")
    parser.add_argument("--cases", action="store_true", help="a line for every case too")
    given = parser.parse_args(arguments)
    lines = []
    for path in sorted(p for folder in given.folders for p in (folder / "truth").glob("*.json")):
        level = json.loads(path.read_text(encoding="utf-8"))["level"]
        if level in STRENGTHS and level in given.levels.split(","):
            lines.append(case_line(path, given))
            if given.cases:
                print(json.dumps(lines[-1]), flush=True)
    print(table(lines))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
