"""Scores frozen answers: `python -m tests.hidden.score FOLDER ... [--failures]`.

Opens the truth, prints one line per level beside the goals of EVIDENCE.md, writes score.json.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from .answers import Answer, identity, read_answer, read_prediction_errors, read_predictions
from .calibration import calibration, reliability, stated
from .discrimination import tells_apart
from .judge import (
    ALIKE,
    TOLD_APART,
    Mark,
    as_classes,
    coverage,
    foretold,
    heldout_ratio,
    kin,
    mark,
    told_at_best,
)
from .run import digest

# level -> (content, least share right or None, greatest share of cases with a wrong name or None)
GOALS: dict[str, tuple[str, float | None, float | None]] = {
    "L0": ("clean", 0.99, None),
    "L1": ("one effect, strong", 0.95, None),
    "L2": ("one effect, 8-25", 0.90, None),
    "L3": ("one effect, 4-8", 0.80, 0.03),
    "L4": ("one of a near pair", 0.90, None),
    "L5": ("exact alias", 1.00, 0.0),
    "L6.2": ("2 effects at once", 0.95, None),
    "L6.3": ("3 effects at once", 0.80, None),
    "L6.4": ("4 effects at once", 0.88, None),
    "L7": ("not in the catalogue", None, 0.20),
    "L8": ("clean, messy noise", 0.98, None),
    "L9": ("unknown robot, all at once", 0.80, None),
    "L10": ("right in kind, wrong in detail", 0.80, 0.03),
    "L11": ("positions of a sagging arm", 0.80, None),
    "L11.rigid": ("positions, geometry alone", 0.98, 0.02),
    "L12": ("known and foreign together", 0.80, None),
    "L0.plans": ("clean, other plans and noise", 0.98, None),
    "L1.plans": ("L1, other plans and noise", 0.95, None),
    "L2.plans": ("L2, other plans and noise", 0.90, None),
}


class NotFrozen(RuntimeError):
    """Answers were changed after the runner froze them, or never frozen."""


def check_frozen(folder: Path) -> dict[str, Any]:
    """The runner's note, if the answers are still those that it froze."""
    path = folder / "frozen.json"
    if not path.exists():
        raise NotFrozen(f"{path} is missing: let the runner finish first")
    frozen: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    if frozen["files"] != digest(folder):
        raise NotFrozen(f"answers in {folder} are not those that were frozen")
    return frozen


def judge_case(folder: Path, name: str) -> tuple[dict[str, Any], Answer, Mark]:
    """Truth, answer and mark of one case."""
    truth = json.loads((folder / "truth" / f"{name}.json").read_text(encoding="utf-8"))
    answer = read_answer(folder / "answers" / name)
    share, wrong, note = mark(truth, answer)
    effects, springs = coverage(truth, answer, share)
    file = folder / "answers" / name / "predicted.csv"
    predicted = read_predictions(file)
    ratio = heldout_ratio(truth, predicted)
    held = foretold(truth, predicted, read_prediction_errors(file))
    result = Mark(share, wrong, note, ratio, effects, springs, foretold=held)
    if truth["level"] == "L4" and answer.next_poses:
        result = replace(result, settled=tells_apart(truth, folder / "answers" / name))
    return truth, answer, result


def level_of(truth: dict[str, Any]) -> str:
    """Row of the table."""
    return f"L6.{truth['count']}" if truth["level"] == "L6" else str(truth["level"])


def line(level: str, cases: list[tuple[dict[str, Any], Answer, Mark]]) -> dict[str, Any]:
    """One row of the table."""
    marks = [entry[2] for entry in cases]
    count = len(marks)
    right = sum(m.right for m in marks) / count
    wrong = sum(m.wrong > 0 for m in marks) / count
    ratios = [m.ratio for m in marks if m.ratio is not None]
    content, least, most = GOALS[level]
    met: bool | None = None
    if least is not None or most is not None:
        met = (least is None or right >= least - 1e-9) and (most is None or wrong <= most + 1e-9)
    close = None
    if level == "L9":
        # a case without predictions is a failure
        close = sum(r <= 1.2 for r in ratios) / count
        met = bool(met) and bool(ratios) and median(ratios) <= 1.2
    covered = [hit for m in marks for hit in m.effects_covered]
    springs = [hit for m in marks for hit in m.springs_covered]
    settled = [m.settled for m in marks if m.settled is not None]
    held = [m.foretold for m in marks if m.foretold is not None]
    classes = [as_classes(truth, answer, found.right) for truth, answer, found in cases]
    return {
        "level": level,
        "content": content,
        "cases": count,
        "verdicts": dict(Counter(answer.verdict for _, answer, _ in cases)),
        "right": right,
        "right_as_classes": sum(classes) / count,
        "told_at_best": sum(told_at_best(truth) for truth, _, _ in cases) / count,
        "error": float(np.sqrt(max(right * (1 - right), 0.25 / count) / count)),
        "wrong": wrong,
        "points": sum(m.points for m in marks) / count,
        "goal_right": least,
        "goal_wrong": most,
        "met": met,
        "ratio_median": median(ratios) if ratios else None,
        "ratio_close": close,
        "covered": [sum(covered), len(covered)],
        "springs_covered": [sum(springs), len(springs)],
        "foretold": sum(held) / len(held) if held else None,
        "settled": [sum(settled), len(settled)],
        "seconds_median": median(answer.seconds for _, answer, _ in cases),
    }


USUAL = range(90, 111)  # readings of an ordinary campaign
LONG = 10.0  # s


def pace(seconds: list[float]) -> str:
    """How long answers to ordinary campaigns took, of so many seconds."""
    slow = sum(each > LONG for each in seconds)
    return (
        f"cases of {USUAL[0]} to {USUAL[-1]} readings: median {median(seconds):.1f} s of "
        f"{len(seconds)}, {slow} over {LONG:.0f} s, longest {max(seconds):.0f} s"
    )


STRENGTHS = ((0.0, 25.0), (25.0, 60.0), (60.0, float("inf")))


def by_strength(cases: list[tuple[dict[str, Any], Answer, Mark]]) -> list[str]:
    """How often a cause of L10 is named, by its visibility: a larger one never less often."""
    found: list[tuple[float, bool]] = []
    for truth, answer, _ in cases:
        for entry in truth["effects"]:
            members = kin(identity(entry["name"], entry["where"]))
            found.append((entry["left"], any(group & members for group in answer.effects)))
    out = []
    for low, high in STRENGTHS:
        hits = [hit for left, hit in found if low <= left < high]
        if hits:
            out.append(f"L10 causes that leave {low:.0f} to {high:.0f}: {sum(hits)} of {len(hits)} "
                       "named with family and place")  # fmt: skip
    return out


def _percent(value: float | None) -> str:
    return "" if value is None else f"{100 * value:.0f}"


def table(rows: list[dict[str, Any]]) -> str:
    """The table as Markdown."""
    head = (
        "| level | content | cases | right % | wrong name % | goal | met | points "
        "| held-out ratio | 95 % hold effects / springs | s |"
    )
    out = [head, "|" + "---|" * 11]
    for row in rows:
        goal = []
        if row["goal_right"] is not None:
            goal.append(f"≥ {_percent(row['goal_right'])} right")
        if row["goal_wrong"] is not None:
            goal.append(f"≤ {_percent(row['goal_wrong'])} wrong")
        if row["level"] == "L9":
            goal.append("ratio ≤ 1.2")
        ratio = "" if row["ratio_median"] is None else f"{row['ratio_median']:.2f}"
        if row["ratio_close"] is not None:
            ratio += f" (≤ 1.2 in {_percent(row['ratio_close'])} %)"
        held = []
        for hit, asked in (row["covered"], row["springs_covered"]):
            held.append(f"{_percent(hit / asked)} ({asked})" if asked else "-")
        met = {None: "", True: "yes", False: "no"}[row["met"]]
        out.append(
            f"| {row['level']} | {row['content']} | {row['cases']} | {_percent(row['right'])} "
            f"± {_percent(row['error'])} | {_percent(row['wrong'])} | {', '.join(goal)} | {met} "
            f"| {row['points']:.2f} | {ratio} | {' / '.join(held)} | {row['seconds_median']:.1f} |"
        )
    return "\n".join(out)


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, nargs="+", help="several are counted as one table")
    parser.add_argument("--failures", action="store_true", help="list every case that lost points")
    given = parser.parse_args(arguments)
    folders: list[Path] = given.folder
    frozen, *others = [check_frozen(folder) for folder in folders]
    for other in others:
        if (other["program"], other["batched"]) != (frozen["program"], frozen["batched"]):
            raise NotFrozen("the folders were answered by different programs, or not in one way")
    judged, ordinary = {}, []
    for folder in folders:
        lead = f"{folder.name}/" if others else ""
        for path in sorted((folder / "truth").glob("*.json")):
            judged[lead + path.stem] = judge_case(folder, path.stem)
            readings = folder / "cases" / path.stem / "train.csv"
            if readings.is_file() and len(readings.read_text("utf-8").splitlines()) - 1 in USUAL:
                ordinary.append(judged[lead + path.stem][1].seconds)
    rows = []
    for level in GOALS:
        cases = [entry for entry in judged.values() if level_of(entry[0]) == level]
        if cases:
            rows.append(line(level, cases))
    print(f"answers of {frozen['program']}, frozen {frozen['when']}")
    if frozen["batched"]:
        print(
            f"many cases in one process; {frozen['again']} of them once more in processes of "
            f"their own, {len(frozen['otherwise'])} of which came out otherwise"
            if frozen.get("again")
            else "run in batch mode: not for publication"
        )
    print(table(rows))
    for row in rows:
        if row["settled"][1]:
            print(f"{row['level']}: next poses settle {row['settled'][0]} of {row['settled'][1]}")
    for row in rows:
        if row["right_as_classes"] > row["right"]:
            print(
                f"{row['level']}: {_percent(row['right_as_classes'])} % right where causes that "
                f"lie less than {ALIKE:g} of the noise apart count as one"
            )
    for row in rows:
        if row["level"] == "L9":
            print(
                "L9: an answer that gives each cause as the set of what lies less than "
                f"{TOLD_APART:g} of the noise from it would be {_percent(row['told_at_best'])} % "
                "right"
            )
    if ordinary:
        print(pace(ordinary))
    results = [result for _, _, result in judged.values()]
    for what, hits in (
        ("effect parameters", [hit for result in results for hit in result.effects_covered]),
        ("springs", [hit for result in results for hit in result.springs_covered]),
    ):
        if hits:
            held = 100.0 * sum(hits) / len(hits)
            print(f"over all levels 95 % intervals hold {held:.1f} % of {len(hits)} {what}")
    share = [r.foretold for r in results if r.foretold is not None]
    if share:
        levels = ", ".join(
            f"{row['level']} {_percent(row['foretold'])}"
            for row in rows if row["foretold"] is not None
        )  # fmt: skip
        print(
            f"95 % intervals of predictions at poses that were not read hold "
            f"{100.0 * sum(share) / len(share):.1f} % of what is true there ({levels})"
        )
    calibrated = {
        what: calibration(pairs)
        for what, pairs in stated((truth, answer) for truth, answer, _ in judged.values()).items()
    }
    for what, found in calibrated.items():
        print(reliability(what, found) if found else f"no probabilities of {what} are told")
    for text in by_strength([entry for entry in judged.values() if entry[0]["level"] == "L10"]):
        print(text)
    document = {
        "calibration": {what: found and asdict(found) for what, found in calibrated.items()},
        "frozen": {key: frozen[key] for key in ("program", "when", "batched")},
        "levels": rows,
        "cases": {
            name: {"level": level_of(truth), "truth": [e["name"] + ":" + e["where"]
                   for e in truth["effects"]], "verdict": answer.verdict, **asdict(result)}
            for name, (truth, answer, result) in judged.items()
        },
    }  # fmt: skip
    (folders[0] / "score.json").write_text(json.dumps(document, indent=1), encoding="utf-8")
    if given.failures:
        for name, (truth, _, result) in judged.items():
            if result.right < 1.0:
                told = ", ".join(f"{e['name']}:{e['where']} ({e['left']:.0f})"
                                 for e in truth["effects"]) or "nothing"  # fmt: skip
                near = truth["effects"][0]["rivals"][:1] if truth["effects"] else []
                beside = (
                    f" [nearest {near[0]['name']}:{near[0]['where']} {near[0]['separation']}]"
                    if near
                    else ""
                )
                print(f"{name} {level_of(truth)} {truth['robot']} {truth['note']}: {told}{beside} "
                      f"-> {result.note}")  # fmt: skip
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
