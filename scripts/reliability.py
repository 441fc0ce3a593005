"""Are the stated probabilities frequencies? The table and picture of docs/RELIABILITY.md.

    python scripts/reliability.py FOLDER ... --seed 20261501 --out docs

FOLDER: sealed cases that were answered (`python -m tests.hidden.run`), of draws that were not used
to make the procedure. Writes RELIABILITY.md and reliability.png: how often names at each stated
probability were true, the expected calibration error and the Brier score. Every draw that was ever
published stays in reliability_draws.csv, and all of them together have a section of their own.
"""

from __future__ import annotations

import argparse
import csv
import sys
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from scipy import stats

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.hidden.calibration import Bin, Calibration, calibration, reliability, stated
from tests.hidden.judge import Mark
from tests.hidden.score import check_frozen, judge_case, level_of

HEAD = """# Are the stated probabilities frequencies?

{count} sealed cases of the hidden benchmark{part}, drawn after the procedure was settled and
answered through the public command ({levels}). Few cases leave wide bars.

Below: names that `explain` gave, and all candidates that `probabilities` lists, by the probability
that was stated. True: the name, one of its alternatives, its family where laws are wrong in detail
(L10), or its kind where the cause itself has no name (`tests/hidden/families.py`), was at work.
Made by `python scripts/reliability.py`.

![stated against true](reliability.png)
"""

ALL = """
## All draws that were published

{cases} cases of {draws} draws. Each was fresh for the state of the program that answered it, and
the procedure was changed between them, partly by what they showed: this is how far stated
probabilities could be believed over its history, the last draw alone is how far they can be now.

"""
DRAWS = "reliability_draws.csv"
COLUMNS = ("seed", "date", "cases", "what", "from", "count", "stated", "true", "brier")


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", type=Path, nargs="+")
    parser.add_argument("--seed", required=True, help="of the draw, under which it is kept")
    parser.add_argument("--part", default="", help="which of the draw these are, if not all")
    parser.add_argument("--out", type=Path, default=Path("docs"))
    asked = parser.parse_args(arguments)
    judged, levels, marks = [], Counter[str](), defaultdict[str, list[Mark]](list)
    for folder in asked.folders:
        check_frozen(folder)
        for case in sorted((folder / "cases").iterdir()):
            truth, answer, mark = judge_case(folder, case.name)
            judged.append((truth, answer))
            levels[level_of(truth)] += 1
            marks[level_of(truth)].append(mark)
    found = {what: calibration(pairs) for what, pairs in stated(judged).items()}
    told = {what: seen for what, seen in found.items() if seen is not None}
    text = HEAD.format(
        count=len(judged),
        part=f" ({asked.part})" if asked.part else "",
        levels=", ".join(f"{n} of {level}" for level, n in sorted(levels.items())),
    )
    text += "\n| level | cases | right | cases with a wrong name |\n|---|---|---|---|\n"
    for level, own in sorted(marks.items()):
        right = sum(mark.right for mark in own) / len(own)
        wrong = sum(mark.wrong > 0 for mark in own)
        text += f"| {level} | {len(own)} | {100.0 * right:.0f} % | {wrong} |\n"
    text += "".join(
        f"\n## {w.capitalize()}\n\n{reliability(w, seen)}\n" for w, seen in told.items()
    )
    kept = with_draw(asked.out / DRAWS, asked.seed, len(judged), told)
    text += of_all(kept)
    (asked.out / "RELIABILITY.md").write_text(text, encoding="utf-8")
    drawn(told).savefig(asked.out / "reliability.png", dpi=110)
    print(text)
    return 0


def with_draw(
    file: Path, seed: str, cases: int, told: Mapping[str, Calibration]
) -> list[dict[str, str]]:
    """The rows of all draws, this one in the place of what its seed had; written to the file."""
    with file.open(encoding="utf-8", newline="") as text:
        rows = [row for row in csv.DictReader(text) if row["seed"] != seed]
    today = datetime.now(UTC).date().isoformat()
    for what, seen in told.items():
        for b in seen.bins:
            numbers = (b.low, b.count, f"{b.stated:.3f}", f"{b.true:.3f}", f"{seen.brier:.3f}")
            row = (seed, today, cases, what, *numbers)
            rows.append(dict(zip(COLUMNS, map(str, row), strict=True)))
    with file.open("w", encoding="utf-8", newline="") as text:
        out = csv.DictWriter(text, COLUMNS, lineterminator="\n")
        out.writeheader()
        out.writerows(rows)
    return rows


def of_all(rows: Sequence[Mapping[str, str]]) -> str:
    """The section on all draws together."""
    cases = {row["seed"]: int(row["cases"]) for row in rows}
    kinds = list(dict.fromkeys(row["what"] for row in rows))
    pooled = [reliability(what, together(r for r in rows if r["what"] == what)) for what in kinds]
    return ALL.format(cases=sum(cases.values()), draws=len(cases)) + "\n\n".join(pooled) + "\n"


def together(rows: Iterable[Mapping[str, str]]) -> Calibration:
    """One calibration of the bins of several draws."""
    numbers = [[float(row[name]) for name in COLUMNS[4:]] for row in rows]
    bins = []
    for low in sorted({each[0] for each in numbers}):
        _, n, *shares = np.array([each for each in numbers if each[0] == low]).T
        stated_, true, _ = (float(np.average(share, weights=n)) for share in shares)
        bins.append(Bin(low, low + 0.1, int(n.sum()), stated_, true))
    count = sum(b.count for b in bins)
    error = sum(b.count * abs(b.stated - b.true) for b in bins) / count
    brier = float(np.average([each[4] for each in numbers], weights=[each[1] for each in numbers]))
    return Calibration(count, error, brier, bins)


def drawn(told: Mapping[str, Calibration]) -> Figure:
    """Stated against true, with 95 % intervals of the counts (Clopper and Pearson)."""
    figure = Figure(figsize=(7.2, 3.4), layout="constrained")
    panels = figure.subplots(1, len(told), squeeze=False)[0]
    for panel, (what, seen) in zip(panels, told.items(), strict=True):
        panel.plot([0, 1], [0, 1], color="#8A96A3", linewidth=1.0)
        x = np.array([b.stated for b in seen.bins])
        y = np.array([b.true for b in seen.bins])
        n = np.array([b.count for b in seen.bins])
        hits = np.round(y * n)
        low = np.nan_to_num(stats.beta.ppf(0.025, hits, n - hits + 1), nan=0.0)
        high = np.nan_to_num(stats.beta.ppf(0.975, hits + 1, n - hits), nan=1.0)
        panel.errorbar(x, y, [y - low, high - y], fmt="o", color="#0072B2", capsize=2)
        for each in seen.bins:
            panel.annotate(str(each.count), (each.stated, each.true), xytext=(4, -11),
                           textcoords="offset points", fontsize=7)  # fmt: skip
        panel.set_title(f"{what}: error {seen.error:.3f}, Brier {seen.brier:.3f}", fontsize=9)
        panel.set_xlabel("stated probability")
        panel.set_ylabel("share that was true")
        panel.set_xlim(-0.03, 1.03)
        panel.set_ylim(-0.03, 1.03)
    return figure


if __name__ == "__main__":
    raise SystemExit(main())
