"""One parameter of a model, and parameters as a table in the units that people write."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.effects import Effect, ParameterSpec
from sk120stiff.errors import require

if TYPE_CHECKING:
    import pandas as pd

UNTRUSTED = "not to be trusted"  # in the origin of a value that no readings stand behind
UNSEEN = f"not identifiable, {UNTRUSTED}"
TOGETHER = f"identified: known only together with others, {UNTRUSTED} alone"
ON_BOUND = "identified: on its bound"
CALIBRATED = "identified: up to the calibration of an instrument"


@dataclass(frozen=True, repr=False)
class Parameter:
    """One parameter of a model.

    Attributes:
        effect: The effect that it belongs to.
        spec: Its name, unit, bounds.
        internal: Internal value (a compliance where people say stiffness), SI.
        internal_std: Standard error of the internal value, None where it was not estimated.
        free: Estimated by identification unless it is told otherwise.
        origin: Where the value came from, in words.
    """

    effect: Effect
    spec: ParameterSpec
    internal: float = 0.0
    internal_std: float | None = None
    free: bool = True
    origin: str = ""

    def __repr__(self) -> str:
        error = "" if self.std is None else f" ± {self.std:.2g}"
        return f"<Parameter {self.name} = {self.value:.4g}{error} {self.spec.unit}>"

    @property
    def name(self) -> str:
        """``effect:where.parameter``."""
        return f"{self.effect.id}.{self.spec.name}"

    @property
    def quantity(self) -> str:
        """What it measures, under every law of its effect: ``effect:where.quantity``."""
        return f"{self.effect.id}.{self.spec.quantity or self.spec.name}"

    @property
    def value(self) -> float:
        """The value as people write it, in `spec.unit`."""
        return self.spec.public(self.internal)

    @property
    def std(self) -> float | None:
        """Standard error of the public value."""
        if self.internal_std is None:
            return None
        return self.spec.public_std(self.internal, self.internal_std)

    @property
    def seen(self) -> bool:
        """The readings that it was identified from tell its value at all; True if given by hand."""
        return self.origin != UNSEEN

    @property
    def trusted(self) -> bool:
        """Its value may be used by itself."""
        return UNTRUSTED not in self.origin

    @property
    def note(self) -> str:
        """What is to be said beside the value, in words; empty where the number says it all."""
        if not self.seen:
            return "not seen in these readings"
        if not self.trusted:
            return "known only together with others"
        if self.origin == CALIBRATED:
            return "its ± holds the usual error of a calibrated instrument"
        if self.origin == ON_BOUND:
            return "on its bound: rigid fits best" if self.spec.reciprocal else "on its bound"
        return ""


def parameter_frame(parameters: Sequence[Parameter]) -> pd.DataFrame:
    """One row per parameter: name, value, std, unit, free, note; NaN where there is no std."""
    require("pandas", needed_for="a data frame")
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
