"""Readings that are no readings of this arm: garbage is refused, slips of the pen are told."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from sk120stiff import fit, load_robot, write_measurements
from sk120stiff.data_checks import find_slip, look
from sk120stiff.measurements import NoiseStatement
from tests.attacks.judge import Verdict, heard
from tests.data_checks.random_arms import random_arm
from tests.data_checks.readings import SCALES, Arm, loads_as_if, sk120, spoilt, ur5
from tests.data_checks.table import ARMS, SLIPS, has_a_floor

GARBAGE = {  # what is done to the rows → what stands in the answer
    "readings shifted,1": ("1 row too low",),
    "readings shifted,7": ("this arm explains only",),
    "readings reversed": ("reverse order", "this arm explains only"),
    "shuffled": ("this arm explains only",),
    "random": ("this arm explains only",),
    "sigma in m": ("larger than the readings themselves",),
    "sigma in mm": ("larger than the readings themselves",),
}
BELIEVED = "agree within the noise"


def arms(seeds: Sequence[int]) -> Iterator[tuple[str, Arm]]:
    """The two arms of the tests, and drawn readings of the public ones."""
    yield "sk120", sk120()
    yield "ur5 of the tests", ur5()
    for name, path in ARMS.items():
        for seed in seeds:
            arm = random_arm(load_robot(str(path)), seed)
            readings = replace(
                arm.readings,
                robot=str(path),
                base_frame=arm.robot.base_frame,
                tool_frame=arm.robot.tool_frame,
            )
            yield f"{name} {seed}", Arm(arm.model, readings)


def garbage(
    folder: Path, seeds: Sequence[int] = (1, 2), only: int | None = None
) -> Iterator[Verdict]:
    """Garbage through `identify` and `explain`: an explained refusal, or the slip told."""
    folder.mkdir(parents=True)
    for name, arm in list(arms(seeds))[:only]:
        for kind, words in GARBAGE.items():
            if kind.startswith("sigma"):
                noise = NoiseStatement(sigma=10.0 if kind == "sigma in m" else 10e-3)
                data = replace(arm.readings, noise=noise)
            else:
                data = spoilt(arm, kind)
            robot = data.robot or "motoman_sk120"
            write_measurements(replace(data, robot=robot), folder / "g.csv")
            for command in ("identify", "explain"):
                out = folder / ("found.yaml" if command == "identify" else "answer")
                more = ("--no-report",) if command == "explain" else ()
                found = heard("", command, str(folder / "g.csv"), "--out", str(out), *more)
                loss = found.loss
                if not any(word in found.said for word in words):
                    loss = loss or f"not said: {' or '.join(words)}: {found.said[-300:]}"
                if BELIEVED in found.said or (command == "explain" and out.exists()):
                    loss = loss or "believed"
                yield Verdict(f"{kind}: {command}, {name}", loss, found.seconds)


def slips(folder: Path, seeds: Sequence[int] = (1, 2), every: int = 1) -> Iterator[Verdict]:
    """Each slip of the pen on each arm: told, with the edit that mends it."""
    del folder
    tries = [(name, arm, *slip) for name, arm in arms(seeds) for slip in SLIPS]
    for name, arm, slip, words in tries[::every]:
        if slip in ("shuffled", "random") or (slip == "floor" and not has_a_floor(arm)):
            continue
        found = find_slip(arm.robot, spoilt(arm, slip))
        loss = "" if found and words in found.said and found.remedy else "not told"
        if loss and found:
            loss = f"taken for another: {found.said}"
        yield Verdict(f"{slip}: {name}", loss)


def scale_slips(folder: Path, seeds: Sequence[int] = (1, 2)) -> Iterator[Verdict]:
    """Everything in another unit: told where the arm's springs are known, if only from a fit.

    Where nobody knows them only an inch for a millimetre is certain to be told, and what is right
    must not be doubted; pounds and kilograms hide behind a soft arm or a stiff one.
    """
    del folder
    for name, arm in arms(seeds):
        known = fit(arm.model, arm.readings).model
        for factor, unit in SCALES:
            said = look(known, loads_as_if(arm.readings, factor)).scale
            loss = "" if said and unit in said.sentence else f"not told: {said}"
            yield Verdict(f"{unit}: {name}, springs known", loss)
        for factor in (25.4, 1 / 25.4):
            said = look(arm.model, loads_as_if(arm.readings, factor)).scale
            yield Verdict(f"inch: {name}", "" if said else "not told")
        for model in (known, arm.model):
            doubts = look(model, arm.readings).sentences
            yield Verdict(f"sound: {name}", " ".join(doubts))
