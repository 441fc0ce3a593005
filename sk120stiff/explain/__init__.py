"""Find where model and readings disagree, name what is missing, add it, show the gap shrink."""

from sk120stiff.explain.answer.explanation import Explanation
from sk120stiff.explain.answer.verdict import Verdict, read_verdict
from sk120stiff.explain.findings import Detectable, Finding
from sk120stiff.explain.localise.localisation import Localisation
from sk120stiff.explain.localise.places import localise
from sk120stiff.explain.localise.words import where_sentences
from sk120stiff.explain.options import Options
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.explain.run import explain
from sk120stiff.identify import DOUBTFUL

__all__ = [
    "DOUBTFUL",
    "Detectable",
    "Explained",
    "Explanation",
    "Finding",
    "Localisation",
    "Options",
    "Verdict",
    "explain",
    "localise",
    "read_verdict",
    "where_sentences",
]
