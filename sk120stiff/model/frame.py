"""Parameters as a pandas table, in the units that people write."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import pandas as pd

    from sk120stiff.model.model import Parameter


def parameter_frame(parameters: Sequence[Parameter]) -> pd.DataFrame:
    """One row per parameter: name, value, std, unit, free, note; NaN where there is no std."""
    import pandas as pd

    return pd.DataFrame(
        {
            "name": [p.name for p in parameters],
            "value": [p.value for p in parameters],
            "std": [np.nan if p.std is None else p.std for p in parameters],
            "unit": [p.spec.unit for p in parameters],
            "free": [p.free for p in parameters],
            "note": [p.note for p in parameters],
        }
    )
