"""Results told as reports and scenes: an explanation or a fit in, a `Report` and a `Scene` out."""

from sk120stiff.show.stories.demo_report import demo_report
from sk120stiff.show.stories.explain_report import explain_report
from sk120stiff.show.stories.path_sheet import PathSheet
from sk120stiff.show.stories.positions_report import positions_report
from sk120stiff.show.stories.scenes import explain_scene, identify_scene, plan_scene

__all__ = [
    "PathSheet",
    "demo_report",
    "explain_report",
    "explain_scene",
    "identify_scene",
    "plan_scene",
    "positions_report",
]
