"""What an elastic law returns."""

from __future__ import annotations

from dataclasses import dataclass

from sk120stiff.arrays import Array


@dataclass(frozen=True, eq=False)
class Elongation:
    """What an elastic law returns for k coordinates and P parameters.

    Attributes:
        value: (N, k) elongation [rad or m].
        by_torque: (N, k, k) tangent compliance.
        by_parameter: (N, k, P) derivative by the internal parameters.
    """

    value: Array
    by_torque: Array
    by_parameter: Array
