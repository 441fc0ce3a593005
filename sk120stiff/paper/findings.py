"""Everything that was recomputed, before any verdict."""

from __future__ import annotations

from dataclasses import dataclass

from sk120stiff.paper.appendix import Appendix
from sk120stiff.paper.forces import Critical, DiagonalParts
from sk120stiff.paper.formulation import Formulation
from sk120stiff.paper.identified import Identified
from sk120stiff.paper.posture import Posture, Pull
from sk120stiff.paper.setting import Setting
from sk120stiff.paper.table2 import Table2
from sk120stiff.paper.table3 import Table3
from sk120stiff.paper.table4 import Table4


@dataclass(frozen=True, eq=False)
class Findings:
    """Numbers on every table, figure and formula of the paper."""

    setting: Setting
    table2: Table2
    identified: Identified
    table3: Table3
    table4: Table4
    critical: Critical
    appendix: Appendix
    formulation: Formulation
    posture: Posture
    parts: DiagonalParts
    pulls: tuple[Pull, ...]
