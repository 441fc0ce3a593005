"""Find where model and readings disagree, name what is missing, add it, show the gap shrink."""

from sk120stiff.explain.document import verdict_document
from sk120stiff.explain.explanation import (
    Detectable,
    Evidence,
    Explanation,
    Finding,
    Step,
    Verdict,
)
from sk120stiff.explain.localisation import Localisation
from sk120stiff.explain.localise import localise
from sk120stiff.explain.steering import Options
from sk120stiff.explain.where_words import where_sentences
from sk120stiff.explain.workflow import explain
from sk120stiff.identify import DOUBTFUL

__all__ = [
    "DOUBTFUL",
    "Detectable",
    "Evidence",
    "Explanation",
    "Finding",
    "Localisation",
    "Options",
    "Step",
    "Verdict",
    "explain",
    "localise",
    "verdict_document",
    "where_sentences",
]
