"""Positions of several markers under several payloads, at poses that are off by their own."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

import sk120stiff as sk
from sk120stiff.measurements import Measurements
from tests.positions.arm import NAMES, errors, poses, tracked, write

SIGMA, OFF = 1.5e-5, 4e-5  # m of a reading; rad that every joint of every pose stands off by
FIT = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
PLACES = {"A": (0.05, -0.08, 0.12), "B": (-0.07, 0.05, 0.10), "C": (0.02, 0.09, 0.18)}


def campaign(
    folder: Path, seed: int, count: int, *, loads: tuple[float, ...], markers: str,
    off: float = OFF, moved: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> Measurements:  # fmt: skip
    """Every marker under every payload at poses whose joints are not where encoders read.

    Under payloads beyond zero all markers sit elsewhere, by `moved` [m].
    """
    a, rng, arm = poses(count, seed), np.random.default_rng(seed), errors(seed)
    q = a + off * rng.normal(size=a.shape)
    rows, cells, seen = [], [], []
    for load in loads:
        for name in markers:
            marker = np.array(PLACES[name]) + np.array(moved) * (load > 0.0)
            at = replace(arm, marker=marker, payload=load)
            seen.append(tracked(at.stands(q)[0]))
            rows.append(a)
            cells += [f"{name},{load},p{k}" for k in range(len(a))]
    x = np.concatenate(seen)
    x += SIGMA * rng.normal(size=x.shape)
    settings = FIT + "payload: {point: {xyz: [0, 0, 0], unit: mm}}\n"
    more = {"more": ",marker,payload[kg],pose", "cells": cells}
    data = sk.read(write(folder, np.concatenate(rows), x, settings, **more))
    return data.with_joints(NAMES)
