"""Faults in what is made of loads that turn with the tool."""

# ruff: noqa: E501

from __future__ import annotations

from scripts.mutations_fault import Fault, of, tests

OF_LOADS: tuple[Fault, ...] = (
    *of(
        "stiffness/cartesian.py", *tests("model", "follower"), *tests("effects", "contract"),
        a_force_that_turns_backwards=("near @ np.swapaxes(np.concatenate(turning", "-near @ np.swapaxes(np.concatenate(turning"),
    ),
    *of(
        "model/true_load.py", *tests("model", "follower"),
        a_sensor_that_stays_while_the_tool_turns=("if not load_cases.follows:", "if True:"),
        a_payload_that_turns_with_the_tool=("hanging = load_cases.hanging", "hanging = 0.0 * load_cases.hanging"),
    ),
    *of(
        "model/sensitivities.py", *tests("positions", "sensitivities"),
        errors_of_a_sensor_along_the_unloaded_tool=("(loaded.rotation, load.of_follower)", "(load_cases.rotation, load.of_follower)"),
    ),
    *of(
        "identify/checks/tool_axes.py", *tests("identify", "tool_axes"),
        axes_of_joint_angles_for_a_sensor=("share = float(own @ left) / size", "share = 1.0"),
    ),
)  # fmt: skip
