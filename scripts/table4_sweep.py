"""Table IV of the 2005 paper at a step of 0.01 rad instead of 0.2: 40 million postures, 8 loads.

    python scripts/table4_sweep.py [--step 0.01] [--out FOLDER]

K_C at the flange is classified at every posture of the first three joints' motion range, under a
force of ±100 N along each axis. Prints the counts, and writes them as table4.csv with a picture of
the classes over joints 2 and 3. Takes some minutes on two cores. With --step 0.2 the counts are
those of `sk120stiff paper`.
"""

from __future__ import annotations

import argparse
import csv
import io
import sys
import time
from pathlib import Path

import numpy as np

from sk120stiff import load_robot
from sk120stiff.files import write_atomically
from sk120stiff.paper.printed import COMPONENT, LOWER, UPPER, printed_counts
from sk120stiff.show.figures import definiteness_map
from sk120stiff.show.figures.saving import save_figure
from sk120stiff.stiffness import CLASSES, ConstantCompliance, under_load

SPRINGS = np.array([1.4098e6, 4.0076e5, 9.3528e5, np.inf, np.inf, np.inf])  # N·m/rad
PIECE = 200_000  # postures at a time


def sweep(step: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, int]:
    """Classes (8, 5), counts of det K_C > 0 and of K_θ − K_C positive definite (8,), postures."""
    robot = load_robot("motoman_sk120")
    arm = ConstantCompliance.of_springs(robot, SPRINGS)
    axes = [np.arange(low, high + 1e-9, step) for low, high in zip(LOWER, UPPER, strict=True)]
    shape = tuple(len(axis) for axis in axes)
    size = int(np.prod(shape))
    signs, _ = printed_counts()
    loads = np.zeros((len(signs), 1, 6))
    loads[:, 0, :3] = COMPONENT * signs
    classes = np.zeros((len(signs), len(CLASSES)), dtype=int)
    determinant, stable = np.zeros(len(signs), dtype=int), np.zeros(len(signs), dtype=int)
    want = ("K_C", "complementary_class", "stiffness_class")
    begin = time.perf_counter()
    for first in range(0, size, PIECE):
        where = np.unravel_index(np.arange(first, min(first + PIECE, size)), shape)
        a = np.zeros((len(where[0]), robot.n))
        for joint, (axis, index) in enumerate(zip(axes, where, strict=True)):
            a[:, joint] = axis[index]
        found = under_load(arm, a, loads, want)
        K = found.of("K_C")
        det = K[..., 0, 0] * (K[..., 1, 1] * K[..., 2, 2] - K[..., 1, 2] * K[..., 2, 1])
        det -= K[..., 0, 1] * (K[..., 1, 0] * K[..., 2, 2] - K[..., 1, 2] * K[..., 2, 0])
        det += K[..., 0, 2] * (K[..., 1, 0] * K[..., 2, 1] - K[..., 1, 1] * K[..., 2, 0])
        determinant += (det > 0.0).sum(axis=1)
        stable += (found.of("stiffness_class") == 0).sum(axis=1)
        for case, row in enumerate(found.of("complementary_class")):
            classes[case] += np.bincount(row, minlength=len(CLASSES))
        done, seconds = first + len(a), time.perf_counter() - begin
        rest = seconds / done * (size - done)
        print(f"\r{done:,} of {size:,} postures, {rest:.0f} s left ", end="", file=sys.stderr)
    print(f"\r{size:,} postures × {len(signs)} loads in {seconds:.0f} s ", file=sys.stderr)
    return classes, determinant, stable, size


def picture(step: float, path: Path) -> None:
    """Classes over joints 2 and 3 with joint 1 at zero, one panel per load."""
    robot = load_robot("motoman_sk120")
    arm = ConstantCompliance.of_springs(robot, SPRINGS)
    x, y = (np.arange(LOWER[k], UPPER[k] + 1e-9, step) for k in (1, 2))
    signs, _ = printed_counts()
    loads = np.zeros((len(signs), 1, 6))
    loads[:, 0, :3] = COMPONENT * signs
    a = np.zeros((len(y), len(x), robot.n))
    a[..., 1], a[..., 2] = np.meshgrid(x, y)
    want = ("complementary_class",)
    found = under_load(arm, a.reshape(-1, robot.n), loads, want)
    titles = ["".join("+" if sign > 0 else "−" for sign in row) for row in signs]
    figure = definiteness_map(
        x,
        y,
        found.of("complementary_class").reshape(-1, len(y), len(x)).astype(np.intp),
        x_label="joint 2",
        y_label="joint 3",
        titles=[f"F = {title} 100 N" for title in titles],
    )
    save_figure(figure, path)


def main() -> None:
    """Sweep, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--step", type=float, default=0.01, help="step of all three joints [rad]")
    parser.add_argument("--out", type=Path, default=Path("table4"), help="folder for the results")
    given = parser.parse_args()
    classes, determinant, stable, size = sweep(given.step)
    signs, printed = printed_counts()
    head = ["force signs", *(each.short for each in CLASSES), "det(K_C) > 0", "K_theta - K_C PD"]
    print("\nshares in percent; in brackets what is printed (its PD counts det(K_C) > 0)")
    print("  ".join(f"{name:>14}" for name in head))
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow([*head, "postures"])
    for k, row in enumerate(signs):
        sign = "".join("+" if s > 0 else "-" for s in row)
        writer.writerow([sign, *classes[k], determinant[k], stable[k], size])
        shares = 100.0 * classes[k] / size
        whole = printed[k].sum()
        cells = [f"{sign:>14}", *(f"{share:14.2f}" for share in shares)]
        cells.append(f"{100 * determinant[k] / size:7.2f}({100 * printed[k, 0] / whole:.2f})")
        cells.append(f"{100 * stable[k] / size:14.2f}")
        print("  ".join(cells))
    for k, row in enumerate(signs):
        other = int(np.flatnonzero((signs == -row).all(axis=1))[0])
        if classes[k, 0] != classes[other, 2]:
            raise SystemExit("PD under F and ND under -F differ, which linearity forbids")
    write_atomically(given.out / "table4.csv", text.getvalue())
    picture(given.step, given.out / "table4.png")
    print(f"\nwritten: {given.out / 'table4.csv'}, {given.out / 'table4.png'}")


if __name__ == "__main__":
    main()
