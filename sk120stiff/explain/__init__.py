"""Find where model and readings disagree, name what is missing, add it, show the gap shrink."""

from sk120stiff.explain.document import noise_floor, verdict_document
from sk120stiff.explain.explanation import (
    Detectable,
    Evidence,
    Explanation,
    Finding,
    Step,
    Verdict,
)
from sk120stiff.explain.workflow import Options, explain

__all__ = [
    "Detectable",
    "Evidence",
    "Explanation",
    "Finding",
    "Options",
    "Step",
    "Verdict",
    "explain",
    "noise_floor",
    "verdict_document",
]
