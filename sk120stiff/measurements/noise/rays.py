"""Positions told along the ray of the instrument and across it: as it is sure of them.

A tracker measures along its ray by interference and across it by angles; a camera knows least of
all how far away things are. In those directions the errors of a position are independent, so its
three numbers are told along them, each with an uncertainty of its own.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array, rms
from sk120stiff.measurements.channels import Channels
from sk120stiff.measurements.noise_statement import Instrument


def along_rays(channels: Channels, instrument: Instrument) -> Channels:
    """The channels with positions along the instrument's rays.

    A position with a blank axis has no ray: its other axes are as unsure as the duller direction.

    Args:
        channels: N rows in axes of the instrument, or of the base.
        instrument: Its place in the same axes.

    Examples:
        >>> import numpy as np
        >>> from sk120stiff.measurements import Instrument
        >>> seen = Channels(position=np.array([[0.0, 0.0, 2.0], [np.nan, 0.0, 2.0]]))
        >>> camera = Instrument((0.0, 0.0, 0.0), along=1e-4, across=2e-5)
        >>> told = along_rays(seen, camera)
        >>> told.rays[0, 0].tolist(), told.sigma_of_rows.tolist()
        ([0.0, 0.0, 1.0], [[0.0001, 2e-05, 2e-05], [0.0001, 0.0001, 0.0001]])
    """
    position = channels.position
    if position is None or "position" not in channels.present:
        return channels
    whole = np.isfinite(position).all(axis=1)
    rays = np.tile(np.eye(3), (len(position), 1, 1))
    sigma = np.full((len(position), 3), max(instrument.along, instrument.across))
    if whole.any():
        ray, along, across = instrument.at(position[whole])
        rays[whole] = frames_of_rays(ray)
        sigma[whole] = np.column_stack([along, across, across])
    sizes = {**channels.sigma, "distance": instrument.along}
    return replace(channels, rays=rays, sigma_of_rows=sigma, sigma=sizes)


def frames_of_rays(ray: Array) -> Array:
    """(N, 3, 3) unit vectors as rows: the ray (N, 3) and two across it."""
    least = np.eye(3)[np.abs(ray).argmin(axis=1)]
    first = np.cross(ray, least)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([ray, first, np.cross(ray, first)], axis=1)


def anywhere(channels: Channels) -> Channels:
    """Channels without what holds at the places that were read alone: rays, and σ along them.

    For readings at other places σ is that of the rays, rms.
    """
    if channels.rays is None or channels.sigma_of_rows is None:
        return channels
    size = rms(channels.sigma_of_rows)
    sigma = {**channels.sigma, "position": size}
    return replace(channels, rays=None, sigma_of_rows=None, sigma=sigma)
