"""A gear turns by a little more or less than its ratio, periodically with the joint's angle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import Geometric
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.parameter import ParameterSpec

HARMONICS = (1, 2)  # once per turn: eccentric; twice: oval


@dataclass(frozen=True)
class TransmissionError(Geometric):
    """The joint stands off its reading by waves over its angle: a gear or a disc is not round."""

    name: ClassVar[str] = "transmission_error"
    place: ClassVar[str] = "a joint that turns"
    equation: ClassVar[str] = "q_true = q + sum over k of a_k sin(k q) + b_k cos(k q)"
    says: ClassVar[str] = "{where} stands off its reading by waves over its turn."
    axes: ClassVar[str] = "the axis of the joint itself"
    needs: ClassVar[str] = "positions"
    only_absolute: ClassVar[bool] = True
    of_transmission: ClassVar[bool] = True

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Amplitudes of sine and cosine, once and twice per turn of the joint."""
        return tuple(
            ParameterSpec(
                f"{wave}_{k}", "rad", "rad", plausible=5e-3, typical=1e-4,
                meaning=f"true minus reported angle in proportion to {wave}({k} q)",
            )
            for k in HARMONICS
            for wave in ("sin", "cos")
        )  # fmt: skip

    def shifts(self, load_cases: LoadCases) -> Array:
        """Waves over the reported angle."""
        q = load_cases.a[:, load_cases.robot.actuated.index(self.where)]
        waves = [wave(k * q) for k in HARMONICS for wave in (np.sin, np.cos)]
        return np.stack(waves, axis=-1)[:, None, :]
