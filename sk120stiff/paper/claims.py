"""Every claim of the paper, in its order, with a verdict that follows from computed numbers."""

from sk120stiff.paper.claims_of_data import claims_of_data
from sk120stiff.paper.claims_of_theory import claims_of_theory
from sk120stiff.paper.findings import Findings
from sk120stiff.paper.verdict import Claim, Verdict

__all__ = ["Claim", "Verdict", "claims"]

# Sections in the order of the paper; a claim is put where it is made.
_ORDER = ("II", "III", "IV", "V", "VI", "Abstract", "Appendix I", "Appendix II")


def claims(found: Findings) -> tuple[Claim, ...]:
    """All claims, section by section."""
    every = [*claims_of_theory(found), *claims_of_data(found)]
    return tuple(sorted(every, key=lambda claim: _ORDER.index(claim.where.split(",")[0])))
