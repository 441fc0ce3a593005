"""How people measure when they do not measure as a benchmark would, and what they say of it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .levels import Rng, Setting, setting
from .noise import Noise


@dataclass(frozen=True)
class Plan:
    """Poses and loads of one way to measure."""

    name: str
    schedule: str | None  # None: any of the usual ones
    poses: int = 20
    loads: int = 5
    clusters: int = 0


PLANS = (
    Plan("one_load", "single", poses=45, loads=1),
    Plan("three_axes", "three_axes", poses=8, loads=3),
    Plan("up_and_down", "up_down"),
    Plan("ladder", "ladder", loads=3),
    Plan("reloads", "reloads", loads=4),
    Plan("clustered", None, clusters=4),
)
USUAL = Plan("usual", None)


def told(noise: Noise, rng: Rng) -> Noise:
    """The same noise with its sigma stated well, 30 % too small or too large, or not at all."""
    kind = rng.choice(["well", "small", "large", "not"], p=[0.4, 0.2, 0.2, 0.2])
    if kind == "well":
        return noise
    factor = {"small": 0.7, "large": 1.3, "not": 0.0}[str(kind)]
    stated = {"sigma": round(1e6 * noise.sigma * factor, 3), "unit": "um"} if factor else None
    return replace(noise, declared={**noise.declared, "noise": stated})


def tracker(rng: Rng) -> Noise:
    """A tracker: alike all around, or sharp along its ray and worse across it; warm, or not yet."""
    noise = Noise(float(np.exp(rng.uniform(np.log(4e-6), np.log(20e-6)))))
    if rng.random() < 0.3:
        # the sensitivity across grows with the distance; the columns state it axis by axis
        far = float(rng.uniform(1e-6, 4e-6))
        noise = replace(noise, angular=far, along=float(rng.uniform(0.3, 0.7)))
        noise = replace(noise, declared={"columns": True})
    else:
        noise = told(noise, rng)
    if rng.random() < 0.25:
        size = noise.sigma * float(rng.uniform(0.5, 1.5))
        noise = replace(noise, warm_up=size, warm_time=float(rng.uniform(8.0, 30.0)))
    return noise


def measured(level: str, seed: tuple[int, ...], rng: Rng, *, usual: float = 0.0) -> Setting:
    """An experiment by one of the plans; `usual`: how often by the benchmark's own instead."""
    chosen = USUAL if rng.random() < usual else PLANS[int(rng.integers(len(PLANS)))]
    noise = tracker(rng)
    columns = "columns" in noise.declared
    at = setting(
        level, seed, rng, schedule=chosen.schedule, noise=noise,
        positions=False if columns else None, shared=False if columns else None,
        poses=chosen.poses, loads=chosen.loads, clusters=chosen.clusters,
    )  # fmt: skip
    return replace(at, plan=chosen.name)
