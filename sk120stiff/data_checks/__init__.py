"""Slips of the pen in measurements: looked for before physics is blamed."""

from sk120stiff.data_checks.copies import without_copies
from sk120stiff.data_checks.look import look, refuse_slips, refuse_unbelievable
from sk120stiff.data_checks.search import find_slip
from sk120stiff.data_checks.single_rows import place_of, slips_of_rows
from sk120stiff.data_checks.stuck import without_stuck
from sk120stiff.data_checks.wild import without_wild

__all__ = [
    "find_slip",
    "look",
    "place_of",
    "refuse_slips",
    "refuse_unbelievable",
    "slips_of_rows",
    "without_copies",
    "without_stuck",
    "without_wild",
]
