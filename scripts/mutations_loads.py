"""Faults in what is made of loads that turn with the tool, and of loads in another unit."""

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
        errors_of_a_sensor_along_the_unloaded_tool=("_by_load(load_cases, load, loaded.rotation)", "_by_load(load_cases, load, load_cases.rotation)"),
    ),
    *of(
        "identify/checks/tool_axes.py", *tests("identify", "tool_axes"),
        axes_of_joint_angles_for_a_sensor=("share = float(own @ left) / size", "share = 1.0"),
    ),
    *of(
        "data_checks/part_rows.py", *tests("data_checks", "part_rows"),
        parts_of_any_factor=("return abs(float(free[least])) < FREE", "return True or abs(float(free[least])) < FREE"),
        parts_that_are_noise=("if float(numbers.off(c)[rows].sum()) > (1.0 - OF_ITSELF) * size:", "if False:"),
        parts_that_end_at_their_first_guess=("    step = M // EDGES + 1", "    step = 0"),
        rows_here_and_there_by_least_squares_alone=("for _ in range(ROUNDS):", "for _ in range(0):"),
        sums_of_every_second_row=("            if last % 2:", "            if False:"),
    ),
    *of(
        "data_checks/part_words.py", *tests("data_checks", "part_rows"),
        headers_that_are_not_read=("table = None if path is None else read_table(path)", "table = None"),
        readings_too_large_for_loads_too_small=("if abs(by * times - 1.0) < SAME:", "if abs(by / times - 1.0) < SAME:"),
    ),
    *of(
        "data_checks/scale.py", *tests("data_checks", "scale"),
        a_rail_that_yields_as_its_arm=("measurements, rails)", "measurements)"),
    ),
    *of(
        "explain/judge/borne_out.py", *tests("explain", "borne_out"),
        every_reading_has_a_say_of_its_own=("score = np.bincount(pose, each)", "score = each"),
        worse_is_a_contradiction_by_chance_too=("return bool(1.0 - self.share > ", "return True or bool(1.0 - self.share > "),
    ),
)  # fmt: skip
