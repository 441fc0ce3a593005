"""How commands say what a model knows of its own uncertainty."""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array, rms
from sk120stiff.errors import two_digits
from sk120stiff.model import Model

NOT_STORED = "no uncertainty is stored in this model"
NO_REMAINDER = "what the model leaves unexplained could not be told from noise when it was fitted"


def uncertainty_keys(model: Model) -> dict[str, object]:
    """The key `uncertainty` of several commands, without what each adds of its own."""
    known = model.uncertainty
    if known is None:
        return {"stored": False, "reason": NOT_STORED}
    left = known.remainder
    return {
        "stored": True,
        "source": known.source,
        "noise_um": None if known.noise is None else known.noise * 1e6,
        "coverage_factor_95": known.reach(0.95),
        "remainder": {"reason": NO_REMAINDER}
        if left is None
        else {
            "rms_um": left.rms * 1e6,
            "upper_um": left.upper * 1e6,
            "degrees_of_freedom": left.freedom,
            "grows_with_load": left.grows,
            "probability": left.probability,
            "significant": left.significant,
        },
    }


def plus_minus(value: float, std: float) -> str:
    """``649.36 ± 3.2``, the error with two digits; ``± ?`` where it is unknown."""
    if not np.isfinite(value):
        return f"{value:.5g}"
    if not np.isfinite(std):
        return f"{value:.5g} ± ?"
    return f"{value:.5g} ± {two_digits(std)}"


def sentences(
    model: Model,
    std_parameters: Array | None,
    std_remainder: Array | None,
    what: str = "a deflection",
) -> list[str]:
    """± of deflections [m] in words: from the parameters, and from what the model lacks."""
    known = model.uncertainty
    if known is None or std_parameters is None:
        return [
            f"{NOT_STORED[0].upper()}{NOT_STORED[1:]}: 'sk120stiff identify' writes one with it."
        ]
    finite = np.isfinite(std_parameters)
    said = []
    if finite.any():
        said.append(
            f"Uncertainty of {what}, standard deviation per axis: "
            f"{two_digits(1e6 * rms(std_parameters))} µm from the parameters"
            f"{_of_remainder(model, std_remainder)}. 95 %: ± {known.reach(0.95):.3g} times the "
            "whole; the noise of a reading comes on top."
        )
    return said


def _of_remainder(model: Model, std: Array | None) -> str:
    left = None if model.uncertainty is None else model.uncertainty.remainder
    if left is None or std is None:
        return f"; {NO_REMAINDER}"
    size = f"{two_digits(1e6 * rms(std))} µm"
    if not left.significant:
        hidden = "(the fit left no more than noise may make, which hides some)"
        return f", {size} from what it may lack {hidden}"
    return f", {size} from what the model leaves unexplained"
