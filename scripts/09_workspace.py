"""Over the whole workspace: a map, the best posture for a path, and its deflection compensated.

    python scripts/09_workspace.py [FOLDER]

The SK120 with the paper's springs, pushed by 490 N. Writes a map of the stiffness with a page and a
picture of a slice, the posture that serves a milling path best, and the joint commands that cancel
the deflection there, judged also by an arm whose springs are 10 % softer than believed.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from sk120stiff import base_model, joint_spring_model, load_robot
from sk120stiff.exports import export
from sk120stiff.show import cloud_of_map, cloud_page, save_figure, scene_of_model
from sk120stiff.show.figures import stiffness_slice
from sk120stiff.workspace import (
    Grid,
    JointGrid,
    MapJob,
    PathTask,
    Placement,
    best_posture,
    compensate,
    elastic_arm,
    open_map,
    parse_axes,
    standing,
    write_map,
)

LOAD = np.array([0.0, 0.0, -490.0, 0.0, 0.0, 0.0])  # N and N·m on the arm, axes of the base


def main() -> None:
    """Map, posture, compensation, export."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "workspace")
    robot = load_robot("motoman_sk120")
    model = base_model(robot)
    if model is None:
        raise SystemExit("motoman_sk120 has lost its model.yaml")
    arm = elastic_arm(model)

    # A map over joints 1 to 3, and what it looks like.
    limits = {
        joint: (low, high, "angle")
        for joint, low, high in zip(arm.joints, arm.lower, arm.upper, strict=True)
    }
    axes = parse_axes(["joint_1_s=::10; joint_2_l=::2; joint_3_u=::2 deg"], limits)
    rest = np.radians([0.0, 0.0, 0.0, 0.0, -60.0, 0.0])
    job = MapJob(arm, JointGrid(Grid(axes), rest), LOAD[None])
    report = write_map(job, folder / "map.zarr")
    print(f"map: {report.points:,} points, {report.computed:,} computed in {report.seconds:.1f} s")
    dataset = open_map(folder / "map.zarr")
    least = dataset["minimum_stiffness"].isel(load=0, joint_1_s=18)
    figure = stiffness_slice(
        least["joint_2_l"].values,
        least["joint_3_u"].values,
        least.values.T,
        x_label="joint 2",
        y_label="joint 3",
        title="Least stiffness under 490 N downwards",
    )
    save_figure(figure, folder / "slice.png")
    scene = scene_of_model(model, title="Motoman SK120: stiffness over the workspace", a=rest)
    cloud_page(folder / "map.html", scene, cloud_of_map(dataset, robot))

    # The best posture for a line that is milled from above, and the best place for the part.
    middle = np.array([1.6, 0.0, 0.2])
    path = PathTask(
        np.linspace(middle - [0.0, 0.25, 0.0], middle + [0.0, 0.25, 0.0], 11),
        axis=np.array([0.0, 0.0, -1.0]),
        wrench=LOAD,
    )
    reach = np.array([0.3, 0.3, 0.2, 0.0, 0.0, np.radians(45)])
    for label, freedom in (("fixed", None), ("moved", Placement(middle, -reach, reach))):
        best = best_posture(arm, path, minimise="deflection", placement=freedom)
        print(
            f"part {label}: largest deflection {best.objective * 1e6:.0f} µm; chosen blindly "
            f"{best.admissible[0] * 1e6:.0f} to {best.admissible[-1] * 1e6:.0f} µm"
        )

    # Commands that cancel what is left.
    found = compensate(model, best.a, LOAD)
    print(
        f"compensated: {found.before.distance.max() * 1e6:.0f} µm at most become "
        f"{found.after.distance.max() * 1e9:.3f} nm"
    )
    softer = joint_spring_model(robot, model.joint_stiffness() / 1.1)
    left = standing(softer, found.a, best.a, LOAD).distance.max()
    print(f"were the springs 10 % softer than believed, {left * 1e6:.0f} µm would stay")

    # The same arm for a simulator.
    export(model, folder / "sk120.xml", pose=best.a[0])
    print(f"written: {', '.join(sorted(path.name for path in folder.iterdir()))} in {folder}")


if __name__ == "__main__":
    main()
