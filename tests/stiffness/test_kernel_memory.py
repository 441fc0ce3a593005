"""Where the memory of the compiled kernel lies."""

import numpy as np

from sk120stiff import load_robot
from sk120stiff.stiffness import ConstantCompliance
from sk120stiff.stiffness.kernel.layout import PAGE, scratch


def test_the_memory_of_a_thread_begins_on_a_page() -> None:
    """Numbers that straddle cache lines cost a fifth of the speed, in half of all processes."""
    robot = load_robot("ur5e")
    arm = ConstantCompliance.of_springs(robot, np.full(robot.n, 1e5))
    assert arm.fold is not None
    for _ in range(3):
        memory = scratch(arm.fold).x
        assert memory.ctypes.data % PAGE == 0
        assert not memory.any()
        assert memory.flags.c_contiguous
