"""Zeros of the joints by which an uncalibrated arm is off, beside the placing of the tracker.

An arm whose marks were set by eye is off by tens of milliradians in every joint. Over a small part
of its workspace that leaves more than another robot's arm would be allowed to; the fit finds it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.arrays import Array, Mask, rms
from sk120stiff.errors import listed
from sk120stiff.measurements.placing.cloud import Cloud

USUAL = 0.02  # rad; zeros within which they are sought
LARGEST = 0.1  # rad; a joint that is off by more has another convention
STEPS = 4  # of Gauss and Newton
TOLD, LEAST = 3, 1e-3  # zeros that are told, and rad below which none is


@dataclass(frozen=True, eq=False)
class Zeros:
    """What is left with zeros of the joints elsewhere.

    Attributes:
        zero: (n,) true minus reported angle [rad]; of sliding joints none.
        rms: Distance that remains [m].
    """

    zero: Array
    rms: float

    @property
    def small(self) -> bool:
        """They are those of marks that were set by eye."""
        return bool(np.abs(self.zero).max() <= LARGEST)

    def sentence(self, names: Sequence[str], before: float) -> str:
        """What they bring, where `before` is left without [m]."""
        most = [k for k in np.argsort(-np.abs(self.zero))[:TOLD] if abs(self.zero[k]) > LEAST]
        told = listed([f"{names[k]} by {1e3 * self.zero[k]:+.2g} mrad" for k in most])
        return (
            f"Zeros of joints look off what the robot's file states, {told}: with them "
            f"{1e3 * self.rms:.2g} mm are left of {1e3 * before:.2g} mm. 'explain' looks for them "
            "among the causes."
        )


def small_zeros(cloud: Cloud, *, fit_marker: bool) -> Zeros:
    """The zeros that leave least, small ones among those that leave as much."""
    turning = ~np.array(cloud.robot.prismatic)
    zero = np.zeros(cloud.a.shape[1])
    for _ in range(STEPS):
        zero = zero + _step(replace(cloud, a=cloud.a + zero), zero, turning, fit_marker)
    moved = replace(cloud, a=cloud.a + zero)
    return Zeros(zero, moved.placed(fit_marker=fit_marker)[0].rms)


def _step(cloud: Cloud, zero: Array, turning: Mask, fit_marker: bool) -> Array:
    """(n,) what the zeros change, frames free beside them, and markers unless they are stated."""
    found, kept = cloud.placed(fit_marker=fit_marker)
    places = cloud.point + found.marker + found.apart[cloud.group]
    screws = cloud.robot.screws(cloud.a, point=places)
    gap = found.in_base(cloud.x, cloud.station) - screws.position
    slope = screws.linear_jacobian[:, :, turning]
    turned = np.swapaxes(np.cross(np.eye(3), screws.position[:, None]), 1, 2)
    motion = np.concatenate([np.broadcast_to(np.eye(3), turned.shape), turned], axis=2)
    stood = np.eye(len(found.shifts))[cloud.station]
    frames = (motion[:, :, None] * stood[:, None, :, None]).reshape(len(gap), 3, -1)
    mounted = np.eye(len(found.apart))[cloud.group]
    marker = (screws.rotation[:, :, None] * mounted[:, None, :, None]).reshape(len(gap), 3, -1)
    free = [slope, frames, marker] if fit_marker else [slope, frames]
    A = np.concatenate(free, axis=2)[kept].reshape(3 * int(kept.sum()), -1)
    noise = rms(gap[kept])
    held = np.zeros((int(turning.sum()), A.shape[1]))
    held[:, : len(held)] = noise / USUAL * np.eye(len(held))
    b = np.concatenate([gap[kept].ravel(), -held[:, : len(held)] @ zero[turning]])
    out = np.zeros_like(zero)
    out[turning] = np.linalg.lstsq(np.vstack([A, held]), b)[0][: len(held)]
    return out
