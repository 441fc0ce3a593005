"""URDF files of any origin become a `UrdfDocument`: forms, repairs with warnings, refusals."""

from sk120stiff.robot.urdf.dh_table import is_dh_table
from sk120stiff.robot.urdf.document import (
    BALLS,
    HARMLESS,
    Finding,
    Mimic,
    UrdfDocument,
    VisualSpec,
)
from sk120stiff.robot.urdf.frames import FrameChoice, default_frames, fingers_on_way
from sk120stiff.robot.urdf.mimics import refuse_orphans
from sk120stiff.robot.urdf.native import captured_stderr
from sk120stiff.robot.urdf.packages import resolve
from sk120stiff.robot.urdf.reading import document_tree, read_urdf
from sk120stiff.robot.urdf.reduced import with_arm_only
from sk120stiff.robot.urdf.suspicions import locked_on_way, suspicions

__all__ = [
    "BALLS",
    "HARMLESS",
    "Finding",
    "FrameChoice",
    "Mimic",
    "UrdfDocument",
    "VisualSpec",
    "captured_stderr",
    "default_frames",
    "document_tree",
    "fingers_on_way",
    "is_dh_table",
    "locked_on_way",
    "read_urdf",
    "refuse_orphans",
    "resolve",
    "suspicions",
    "with_arm_only",
]
