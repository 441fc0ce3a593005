"""`sk120stiff pilot DIR`."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from sk120stiff.cli.cell import opened_cell
from sk120stiff.cli.frame import Answer, emit, note
from sk120stiff.cli.opening import open_model
from sk120stiff.cli.tables import plan_table, progress_bar, table
from sk120stiff.errors import InputError, two_digits
from sk120stiff.files import validated
from sk120stiff.measurements import Measurements
from sk120stiff.pilot.campaign import Campaign, State
from sk120stiff.pilot.confirming import Confirmation, confirmed
from sk120stiff.pilot.folder import LIKE, READINGS, Folder, Settings
from sk120stiff.pilot.surprise import surprise
from sk120stiff.units import parse_values

BIT = "One bit answers one question of yes or no, or halves one uncertainty."
SHOWN = 6  # names on the screen
LOOK_AGAIN = 1.0  # s between looks at a file that grows
WORDS = {
    "named": "Stop: the name is sure.", "class": "Stop: one of these.", "none": "Stop.",
    "target": "Stop: the target is met.", "hopeless": "Stop: hopeless.", "most": "Stop.",
}  # fmt: skip

_Text = str | None


def command(
    folder: Path,
    model: str | None = None,
    force: _Text = None,
    noise: _Text = None,
    point: _Text = None,
    zero: _Text = None,
    target: _Text = None,
    most: Annotated[int | None, typer.Option(min=1)] = None,
    cell: Path | None = None,
    typed: Annotated[bool, typer.Option("--type")] = False,
    watch: bool = False,
) -> Answer:
    """Which reading comes next, what is known, and when to stop.

    The folder is the state: pilot.yaml holds the settings, readings.csv grows by your hand (or by
    --type), next.csv holds the pose and load to measure next. It can be left and taken up at any
    time. A name that is sure (P of 0.95) is put before the full judgement of 'explain'.

    Example: sk120stiff pilot campaign --model robots/motoman_sk120/model.yaml --point '0,50,120 mm'
    Example: sk120stiff pilot campaign --type

    Args:
        folder (DIR): The campaign's folder.
        model (MODEL): Robot or model file; begins a campaign.
        force (FORCE): Largest load: '400 N'.
        noise (LENGTH): Standard uncertainty of one reading: '10 um'.
        point (XYZ): Measured and loaded point, tool frame: '0,50,120 mm'.
        zero (ZERO): separate: a zero reading for each; or shared.
        target (SHARE): Springs known to this are enough: '2 %'.
        most: Readings at most.
        cell (YAML): What stands around the arm, its rig, its tracker.
        typed: Ask for each reading here, and write it down.
        watch: Look again whenever readings.csv grows.
    """
    at = Folder(folder)
    stated = {
        "model": None if model is None else _seen_from(folder, model),
        "cell": None if cell is None else _seen_from(folder, str(cell)),
        "force": force, "noise": noise, "point": point, "zero": zero, "target": target,
        "most": most,
    }  # fmt: skip
    settings = None
    if model is not None:
        settings = _settings({key: value for key, value in stated.items() if value is not None})
        at.refuse_another(settings)
    elif any(value is not None for value in stated.values()):
        raise InputError(
            "the settings of a campaign are written when it begins",
            where=str(folder),
            remedy="Give --model too to begin one, or edit pilot.yaml.",
        )
    settings = settings or at.settings()
    opened = open_model(str(at.beside(settings.model)) if _is_file(settings) else settings.model)
    around = opened_cell(
        opened.robot,
        None if settings.cell is None else at.beside(settings.cell),
        at.readings_file,
    )
    with progress_bar("what can be measured"):
        campaign = settings.campaign(opened, around)
    if model is not None:
        at.begin(settings)  # now that nothing stands against it
    grown = _grown(at, _changed(at))  # asked now: what comes while the first look lasts counts
    first = _looked(at, settings, campaign)

    def go_on() -> None:
        turn = first
        while _typed(at, campaign, turn) if typed else next(grown):
            try:
                turn = _looked(at, settings, campaign)
            except InputError as error:
                if typed:
                    raise
                note(f"Error: {error}")
                note("Correct the file; it is looked at again when it changes.")
                continue
            emit(turn.answer, as_json=False)
            if turn.over:
                return

    going = (typed or watch) and not first.over
    return replace(first.answer, afterwards=go_on if going else None)


@dataclass(frozen=True)
class _Turn:
    """What is known, what was said of it, and what is to be read next."""

    state: State
    answer: Answer
    plan: Measurements | None
    over: bool


def _settings(said: dict[str, object]) -> Settings:
    settings = validated(Settings, said, lambda key: f"--{key}", LIKE)
    try:
        return settings.checked()
    except InputError as error:
        raise InputError(error.what, where=f"--{error.where}", remedy=error.remedy) from error


def _seen_from(folder: Path, named: str) -> str:
    """A file as seen from the folder; a bundled robot by its name."""
    if not Path(named).exists():
        return named
    return Path(os.path.relpath(Path(named).resolve(), folder.resolve())).as_posix()


def _is_file(settings: Settings) -> bool:
    return "/" in settings.model or "." in settings.model


def _looked(at: Folder, settings: Settings, campaign: Campaign) -> _Turn:
    readings = at.readings(settings)
    with progress_bar("which reading next"):
        state = campaign.state(readings)
        asked = None
        if readings is not None and state.stop and state.stop.reason in ("named", "class"):
            asked = confirmed(campaign.model, readings, state.stop)
    plan = None
    if state.row is not None:
        plan = at.propose(campaign, settings, state.row, f"p{state.count + 1}")
    final = state.stop is not None and (asked is None or asked.agrees)
    return _Turn(state, _answer(at, campaign, state, plan, asked, final), plan, final)


def _answer(
    at: Folder, campaign: Campaign, state: State, plan: Measurements | None,
    asked: Confirmation | None, final: bool,
) -> Answer:  # fmt: skip
    names = list(state.belief.probabilities.items()) if state.belief.linear.effects else []
    rows = [
        (
            name,
            f"{value:.5g}",
            f"± {two_digits(std)}" if std < abs(value) else "not known yet",
            unit,
        )
        for name, value, std, unit in state.springs
    ]
    said: list[object] = [
        table(
            f"After {state.count} reading{'s' * (state.count != 1)}",
            ["spring", "value", "", "unit"],
            rows,
        ),
    ]
    if names:
        shown = [(n, f"{p:.3f}") for n, p in names[:SHOWN]]
        said.append(table("Probabilities", ["name", "P"], shown))
    if sum(p for _, p in names) > 1.005:
        said.append("A pair of causes counts for both of its names: together they exceed 1.")
    if state.belief.unexplained:
        said.append(
            "More is left than noise, whatever is taken from the catalogue: a slip, a noise stated "
            "too small, or a cause that it lacks."
        )
    if state.stop is not None:
        said.append(f"{WORDS[state.stop.reason]} {state.stop.sentence}" if final else (
            f"{state.stop.sentence} The full judgement is not convinced yet "
            f"({asked.verdict if asked else ''}): go on."
        ))  # fmt: skip
    if plan is not None and not final:
        said += [plan_table("Measure next", plan, 2), f"It would tell {state.decides}. {BIT}"]
        said.append(f"Written to {at.path / 'next.csv'}; what is read goes into {READINGS}.")
    if not state.count:
        said += campaign.pool.remarks
    document = {
        "readings": state.count,
        "springs": [
            {"name": name, "value": value, "std": std, "unit": unit}
            | ({} if np.isfinite(std) else {"reason": "no reading shows it yet"})
            for name, value, std, unit in state.springs
        ],
        "probabilities": [{"name": n, "probability": p} for n, p in names if p > 0.01],
        "unexplained": state.belief.unexplained,
        "stop": None
        if state.stop is None
        else {
            "reason": state.stop.reason, "names": state.stop.names,
            "sentence": state.stop.sentence, "final": final,
            "verdict": None if asked is None else asked.verdict,
        },
        "next": None
        if plan is None
        else {
            "pose": plan.pose[0],
            "joints": dict(zip(plan.joint_names, plan.joints[0].tolist(), strict=True)),
            "wrench": plan.wrench[0],
            "decides": state.decides,
        },
        "remarks": campaign.pool.remarks,
        "out": at.path / "next.csv",
    }  # fmt: skip
    return Answer(document, said)


def _typed(at: Folder, campaign: Campaign, turn: _Turn) -> bool:
    """One reading from the keyboard, written down; False where the input ends."""
    while turn.plan is not None and turn.state.row is not None:
        line = _asked("dx, dy, dz with unit, e.g. 0.12,-0.30,0.05 mm (empty: leave): ")
        if not line:
            return False
        try:
            read = parse_values(line, "length", where="reading", like="0.12,-0.30,0.05 mm")
        except InputError as error:
            note(f"Error: {error}")
            continue
        odd = surprise(campaign, turn.state.belief, turn.state.row, read).words
        if odd:
            note(odd)
            if _asked("Keep it? [y/N]: ").lower() not in ("y", "yes"):
                continue
        at.append(turn.plan, read)
        return True
    return False


def _asked(question: str) -> str:
    print(question, end="", flush=True)
    return sys.stdin.readline().strip()


def _changed(at: Folder) -> int:
    """When the file of readings was last written [ns]; 0 where there is none."""
    try:
        return at.readings_file.stat().st_mtime_ns
    except OSError:
        return 0  # an editor is just replacing it


def _grown(at: Folder, before: int) -> Iterator[bool]:
    """True each time that the file of readings has changed since `before` [ns]."""
    while True:
        time.sleep(LOOK_AGAIN)
        now = _changed(at)
        if now not in (0, before) and _whole(at.readings_file):
            before = now
            yield True


def _whole(file: Path) -> bool:
    """Does it end with its last line? Another program may be in the middle of one."""
    try:
        return file.read_bytes()[-1:] == b"\n"
    except OSError:
        return False
