"""What describes one parameter of an effect: name, units, bounds, and what its value means."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

REFERENCE_LENGTH = 2.87  # m; arms of this size are what usual sizes are stated for


@dataclass(frozen=True)
class ParameterSpec:
    """One parameter of an effect.

    The law works with an internal value that is zero when the effect is absent (a compliance). What
    people write and read may be its reciprocal (a stiffness): `public` and `internal` convert.

    Attributes:
        name: Short name, unique within the effect.
        unit: SI unit of the public value, e.g. ``N*m/rad``.
        internal_unit: SI unit of the internal value.
        reciprocal: The public value is one over the internal one.
        lower, upper: Physical bounds of the internal value.
        plausible: Internal magnitude above which the value is no explanation, however well it fits.
        typical: Internal magnitude worth telling from zero; scales numerics and detectable sizes.
        customary: Internal magnitude up to which it is built as a rule, where what users bring, as
            a foundation on wheels or a tool on rubber, may lie far beyond; None: that is no
            explanation, see `plausible`.
        meaning: What the public value says, in words: along which axis, and what its sign means.
        quantity: What it measures, by one name under every law of its effect that has it; empty:
            no other law does, or it has the same name there.
    """

    name: str
    unit: str
    internal_unit: str
    plausible: float
    typical: float
    reciprocal: bool = False
    lower: float = -np.inf
    upper: float = np.inf
    meaning: str = ""
    quantity: str = ""
    customary: float | None = None

    @property
    def believed(self) -> float:
        """Internal magnitude above which no cause is looked for, unless little else would do."""
        return self.customary or self.plausible

    @property
    def usual(self) -> float:
        """Standard size before anything is read: halfway, in decades, from typical to the largest
        that is customary.
        """
        return float(np.sqrt(self.typical * self.believed))

    def public(self, internal: float) -> float:
        """The value as people write it; infinite stiffness where nothing yields."""
        if not self.reciprocal:
            return internal
        if internal == 0.0:
            return float(np.inf)
        short = float(f"{1.0 / internal:.15g}")  # 50000, not 49999.99999999999
        return short if 1.0 / short == internal else 1.0 / internal

    def internal(self, public: float) -> float:
        """The value as the law uses it."""
        if not self.reciprocal:
            return public
        return 0.0 if np.isinf(public) else 1.0 / public

    def public_std(self, internal: float, std: float) -> float:
        """Standard error of the public value, to first order."""
        if not self.reciprocal:
            return std
        return float(np.inf) if internal == 0.0 else std / internal**2


def of_axes(
    name: str, unit: str, *, plausible: float, typical: float, meaning: str
) -> tuple[ParameterSpec, ...]:
    """Three like parameters; ``{}`` in name and meaning stands for x, y and z."""
    return tuple(
        ParameterSpec(
            name.format(axis), unit, unit, plausible, typical, meaning=meaning.format(axis)
        )
        for axis in "xyz"
    )


#: public unit → internal unit, and the power of an arm's length with which a stiffness grows when
#: the whole arm is drawn larger in the same material
_STIFFNESS = {
    "N*m/rad": ("rad/(N*m)", 3),
    "N/m": ("m/N", 1),
    "N*m**2": ("1/(N*m**2)", 4),
}


def compliance(
    name: str,
    *,
    softest: float,
    typical: float,
    scale: float,
    meaning: str,
    unit: str = "N*m/rad",
    signed: bool = False,
    quantity: str = "",
    customary: float | None = None,
) -> ParameterSpec:
    """A compliance that people give as a stiffness.

    Args:
        softest, typical: Stiffness [unit] below which the value is implausible, and one that is
            often met, on an arm of `REFERENCE_LENGTH`.
        customary: The softest that is customary; see `ParameterSpec`.
        scale: Length of the arm over `REFERENCE_LENGTH`.
        meaning: What the stiffness resists.
        unit: ``N*m/rad``, ``N/m`` or ``N*m**2`` (beams).
        signed: May be negative (a cross term).
        quantity: See `ParameterSpec`.
    """
    inverse, power = _STIFFNESS[unit]
    return ParameterSpec(
        name=name,
        unit=unit,
        internal_unit=inverse,
        plausible=1.0 / (softest * scale**power),
        typical=1.0 / (typical * scale**power),
        reciprocal=True,
        lower=-np.inf if signed else 0.0,
        meaning=meaning,
        quantity=quantity,
        customary=customary and 1.0 / (customary * scale**power),
    )


def compliances(
    axes: str, name: str, *, softest: float, typical: float, scale: float, meaning: str,
    unit: str = "N*m/rad", customary: float | None = None,
) -> tuple[ParameterSpec, ...]:  # fmt: skip
    """Like compliances, one for each letter of `axes`: ``{}`` in name and meaning stands for it."""
    return tuple(
        compliance(
            name.format(axis), softest=softest, typical=typical, scale=scale, unit=unit,
            meaning=meaning.format(axis), customary=customary,
        )
        for axis in axes
    )  # fmt: skip
