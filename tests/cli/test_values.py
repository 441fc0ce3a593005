"""Values below the name of an effect: sure ones, in units that can be compared."""

from dataclasses import replace

from sk120stiff.cli.values import sure_values
from sk120stiff.effects.joint_frame import JointFrame
from sk120stiff.model import Parameter


def test_turns_of_one_frame_are_said_in_one_unit() -> None:
    frame = JointFrame("joint_2_l")
    sizes = {"x": (2e-4, 1e-5), "rx": (-9.2e-3, 2.1e-3), "ry": (0.0208, 2e-3), "rz": (1e-3, 1e-3)}
    own = [
        replace(Parameter(frame, spec), internal=value, internal_std=std)
        for spec in frame.parameters
        if spec.name in sizes
        for value, std in [sizes[spec.name]]
    ]
    assert sure_values(own, ()) == ["  x 200 ± 10 µm, rx −0.53 ± 0.12 °, ry 1.19 ± 0.11 °"]
