"""An instrument that is sharp along its ray and duller across it, as laser trackers are.

Such errors do not keep to the axes in which readings are written: those of the three axes of one
reading go together. Where the instrument stands is stated (``noise: {instrument: ...}``), or the
uncertainties of single readings tell it: with the unit ray r at distance D they have, per axis,
σ_i² = a²(1 − r_i²) + b² r_i², with b along the ray and a across it, each growing with D.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import numpy as np
from scipy import optimize

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError, short
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.noise.rays import frames_of_rays
from sk120stiff.measurements.noise_statement import Instrument

FEWEST = 6  # places of the tool from which an instrument's own can be told
MOST = 60  # of them that are looked at
DISTANCES = (1.5, 3.0, 6.0, 12.0)  # m, from which the search for its place starts
STARTS = 6  # of them that are followed
OFF = 0.03  # relative rms by which told variances may be off the law: they are rounded
TELLS = 0.1  # share of how they vary from place to place that the law may leave
RATIO = 1.2  # of across and along, below which the axes may as well be independent
AMBIGUOUS = 3.0  # times the misfit of the best place: others up to there are as good
SHARPEST = 0.01  # of across, that is told along
SAME_RAY = 0.15  # rad within which two places mean the same rays
SEEN = "instrument that stands at"  # in the sentence that tells it


def may_have_rays(measurements: Measurements) -> bool:
    """Is it still open whether errors of the three axes go together?"""
    told = measurements.noise.instrument is not None or measurements.sigma is not None
    return told and measurements.along is None


def seen_from(measurements: Measurements, points: Array) -> Measurements:
    """The readings with their uncertainty along the ray, where an instrument is stated or shows.

    Args:
        measurements: N readings; those that know their rays already come back as they are.
        points: (N, 3) places of the measured point, base axes, m.

    Raises:
        InputError: An instrument is stated for displacements in tool axes, or stands in a point.
    """
    stated = measurements.noise.instrument
    if not may_have_rays(measurements):
        return measurements
    if stated is not None:
        if measurements.displacement_frame != "base":
            raise InputError(
                "an instrument is stated, but displacements are in axes of the tool",
                where=measurements.place,
                remedy="Give displacements in the base frame, or leave noise.instrument out.",
            )
        told = _by(measurements, stated, points)
        said = f"Readings are weighed by the {_placed(stated, points)}."
        return replace(told, notes=(*told.notes, said))
    found = None
    if measurements.sigma is not None and measurements.displacement_frame == "base":
        found = told_by(points, measurements.sigma)
    if found is None:
        return replace(measurements, along=np.full(points.shape, np.nan))
    told = _by(measurements, found, points)
    return replace(
        told, sigma=measurements.sigma, notes=(*measurements.notes, _sentence(found, points))
    )


def told_by(points: Array, sigma: Array) -> Instrument | None:
    """The instrument whose ray explains the uncertainties of single readings, or None.

    Args:
        points: (N, 3) m, base axes.
        sigma: (N, 3) standard uncertainties along the axes of the base [m].
    """
    whole = np.isfinite(sigma).all(axis=1)
    _, rows = np.unique(np.round(points[whole], 6), axis=0, return_index=True)
    rows = rows[np.linspace(0, len(rows) - 1, min(len(rows), MOST)).astype(np.intp)]
    places, variances = points[whole][rows], sigma[whole][rows] ** 2
    if len(places) < FEWEST:
        return None
    varies = float(np.std(variances / variances.mean(axis=0) - 1.0))
    if varies < 2.0 * OFF * TELLS:
        return None

    def misfit(place: Array) -> Array:
        law = _law(places - place)
        return np.asarray(law @ _parts(law, variances) / variances.ravel() - 1.0)

    starts = sorted(_starts(places), key=lambda place: float(np.square(misfit(place)).sum()))
    fits = [optimize.least_squares(misfit, start, x_scale=1.0) for start in starts[:STARTS]]
    fits.sort(key=lambda fit: fit.cost)
    off = [float(np.sqrt(2.0 * fit.cost / variances.size)) for fit in fits]
    if off[0] > min(OFF, TELLS * varies):
        return None
    rays = _rays(places - fits[0].x)[0]
    for fit, rms in zip(fits, off, strict=True):
        other = _rays(places - fit.x)[0]
        apart = np.arccos(np.clip(np.abs((rays * other).sum(axis=1)), 0.0, 1.0)).max()
        if rms < max(AMBIGUOUS * off[0], 1e-3) and apart > SAME_RAY:
            return None
    parts = _parts(_law(places - fits[0].x), variances)
    across, across_per, along, along_per = np.sqrt(parts)
    along = max(along, SHARPEST * max(across, across_per))  # rounded numbers may tell none at all
    x, y, z = (float(v) for v in fits[0].x)
    found = Instrument((x, y, z), along, across, along_per, across_per)
    _, b, a = found.at(places)
    ratio = float(np.median(a / np.maximum(b, 1e-12)))
    return found if max(ratio, 1.0 / ratio) > RATIO else None


def in_axes_of_sight(along: Array, sigma: Array) -> tuple[Array, Array]:
    """Variances along the ray and twice across it (N, 3), and the axes they are along (N, 3, 3).

    Args:
        along: (N, 3) standard uncertainty along the ray, as a vector along it, m; NaN without one.
        sigma: (N, 3) standard uncertainties along the axes of the base, m; of rows that lack one
            the axes stay those of the base.
    """
    variances, axes = sigma**2, np.broadcast_to(np.eye(3), (len(sigma), 3, 3)).copy()
    whole = np.isfinite(sigma).all(axis=1) & np.isfinite(along).all(axis=1)
    size = np.linalg.norm(along[whole], axis=1)
    ray = along[whole] / size[:, None]
    across = np.maximum(0.5 * (variances[whole].sum(axis=1) - size**2), 1e-4 * size**2)
    variances[whole] = np.stack([size**2, across, across], axis=1)
    axes[whole] = frames_of_rays(ray)
    return variances, axes


def _by(measurements: Measurements, instrument: Instrument, points: Array) -> Measurements:
    """Readings as this instrument takes them."""
    rays, along, across = instrument.at(points)
    squares = across[:, None] ** 2 + (along**2 - across**2)[:, None] * rays**2
    sigma = np.where(measurements.read, np.sqrt(squares), np.nan)
    return replace(measurements, sigma=sigma, along=along[:, None] * rays)


def _sentence(found: Instrument, points: Array) -> str:
    return (
        f"The uncertainties of the axes are those of an {_placed(found, points)}; the errors of "
        "one reading's axes are taken to go together so."
    )


def _placed(instrument: Instrument, points: Array) -> str:
    _, along, across = instrument.at(points)
    x, y, z = instrument.place
    return (
        f"{SEEN} ({x:.2f}, {y:.2f}, {z:.2f}) m, with {short(1e6 * np.median(along))} µm along its "
        f"ray and {short(1e6 * np.median(across))} µm across it"
    )


def _rays(sight: Array) -> tuple[Array, Array]:
    """Unit vectors (N, 3) and lengths (N,)."""
    distance = np.maximum(np.linalg.norm(sight, axis=1), 1e-9)
    return sight / distance[:, None], distance


def _law(sight: Array) -> Array:
    """(3N, 4) variances by the squares of across, across per metre, along and along per metre."""
    rays, distance = _rays(sight)
    along, far = rays.ravel() ** 2, np.repeat(distance**2, 3)
    return np.stack([1.0 - along, (1.0 - along) * far, along, along * far], axis=1)


def _parts(law: Array, variances: Array) -> Array:
    """(4,) squares that bring a law (3N, 4) next to variances (N, 3), by relative errors."""
    columns = law / variances.reshape(-1, 1)
    size = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    values, _ = optimize.nnls(columns / size, np.ones(len(columns)))
    return np.asarray(values / size)


def _starts(points: Array) -> Iterator[Array]:
    """Places all around the points."""
    for way in product((-1.0, 0.0, 1.0), repeat=3):
        length = float(np.linalg.norm(way))
        for distance in DISTANCES:
            if length:
                yield points.mean(axis=0) + distance / length * np.array(way)
