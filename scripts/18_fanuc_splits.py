"""Does the answer for a real arm stay the same on other poses of it? Four splits of cable pulls.

The readings of scripts/17_cable_pulls.py. Every fourth pose is left out, from the first, second,
third and fourth on: so each pose is left out once. `explain` sees the other three quarters; its
model predicts those left out. Lengths are 3-D root mean squares [mm].

Run:  python scripts/18_fanuc_splits.py FOLDER_OF_DATA
      python scripts/18_fanuc_splits.py FOLDER_OF_DATA --sigma 30   # [µm] stated of the tracker
"""

import argparse
import runpy
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import sk120stiff as sk
from sk120stiff.effects import load_cases_of
from sk120stiff.explain import Explanation
from sk120stiff.identify import Fit
from sk120stiff.measurements import Measurements, NoiseStatement

SPLITS = 4
PULLS = runpy.run_path(str(Path(__file__).with_name("17_cable_pulls.py")))


@dataclass(frozen=True)
class Split:
    """What was said of the other poses, and how far off it is at those left out.

    Attributes:
        answer: What `explain` said.
        springs, named: (k,) distances between prediction and reading at the k poses left out, by
            the springs alone and with what was named [m].
    """

    answer: Explanation
    springs: np.ndarray
    named: np.ndarray


def readings(folder: Path, place: Path, sigma: float | None) -> tuple[sk.Model, Measurements]:
    """Springs at every joint, and the pulls with the controller's own columns.

    Args:
        folder: The published files.
        place: Where the converted ones go.
        sigma: Stated standard uncertainty of a reading per axis [m]; None: nobody states it.
    """
    data = sk.read(PULLS["converted"](folder, place))
    robot = sk.load_robot(data.robot, base=data.base_frame, tool=data.tool_frame)
    stated = replace(data.with_joints(robot.actuated), noise=NoiseStatement(sigma=sigma))
    return sk.base_model(robot), stated


def split(model: sk.Model, data: Measurements, number: int) -> Split:
    """One of the four, counted from 0."""
    left_out = np.arange(data.n_readings) % SPLITS == number
    answer = sk.explain(model, data.select(~left_out))
    rest = data.select(left_out)
    return Split(answer, off(answer.base, rest), off(answer.final, rest))


def off(fit: Fit, rest: Measurements) -> np.ndarray:
    """(k,) distance between prediction and reading [m]."""
    gap = rest.displacement - fit.model.predict(load_cases_of(fit.model.robot, rest))
    return np.linalg.norm(gap, axis=1)


def one_left_out(answer: Explanation, data: Measurements) -> np.ndarray:
    """(N,) prediction against reading at each pose by a fit to all the others [m].

    Names, laws and noise are those of the answer; what it set aside is in no fit and is predicted
    by none.
    """
    used = np.setdiff1d(np.arange(data.n_readings), answer.set_aside)
    off_by = []
    for row in used:
        rest = data.select(used[used != row])
        again = sk.fit(answer.final.model, rest, noise=answer.final.problem.noise)
        off_by.append(off(again, data.select(np.array([row]))))
    return np.concatenate(off_by)


def names(answer: Explanation) -> str:
    """Every finding with what the readings cannot tell from it."""
    found = [" or ".join([each.effect.id, *each.alternatives]) for each in answer.findings]
    return f"{answer.verdict}: {', '.join(found) or 'no name'}"


def rms(lengths: np.ndarray) -> float:
    """Root mean square in mm."""
    return 1e3 * float(np.sqrt(np.mean(np.square(lengths))))


def main() -> None:
    """All poses, then the four splits."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="holds joint_angles.csv and the other two")
    parser.add_argument("--sigma", type=float, help="stated uncertainty per axis [µm]")
    given = parser.parse_args()
    if not (given.folder / "joint_angles.csv").is_file():
        parser.error(f"no joint_angles.csv in {given.folder}: give the folder of that arm")
    sigma = None if given.sigma is None else given.sigma * 1e-6
    with tempfile.TemporaryDirectory() as place:
        model, data = readings(given.folder, Path(place), sigma)
        answer = sk.explain(model, data)
        print(f"all {data.n_readings} poses: {names(answer)}")
        print(f"  {answer.remainder.sentence()}")
        for step in answer.steps:
            held = 1e3 * np.sqrt(3.0) * step.heldout_rms
            print(f"  {step.label}: {held:.3f} mm at poses left out, names chosen anew each time")
        alone = rms(one_left_out(answer, data))
        print(f"  {alone:.3f} mm at each pose by a fit to all the others, with the names above")
        found = []
        for k in range(SPLITS):
            one = split(model, data, k)
            found.append(one)
            print(f"without every fourth pose from the {k + 1}. on: {names(one.answer)}")
            print(f"  {rms(one.springs):.3f} mm by springs, {rms(one.named):.3f} mm with names")
    springs, named = (
        np.concatenate([getattr(each, what) for each in found]) for what in ("springs", "named")
    )
    print(f"every pose left out once: {rms(springs):.3f} mm by springs, {rms(named):.3f} mm")


if __name__ == "__main__":
    main()
