"""A map as coloured points around the robot, in a self-contained page for the browser."""

from __future__ import annotations

import base64
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from markupsafe import Markup

from sk120stiff.arrays import Array, Index
from sk120stiff.errors import InputError
from sk120stiff.files import write_atomically
from sk120stiff.show import palette
from sk120stiff.show.scene.frame import Request, compute_frame
from sk120stiff.show.scene.payload import frame_payload, scene_payload
from sk120stiff.show.scene.scene import Scene
from sk120stiff.show.scene.static import environment, json_for_script, script, viewer_script
from sk120stiff.show.wording import load_in_words, number

if TYPE_CHECKING:
    import xarray

    from sk120stiff.robot import Robot

SCRIPTS = (
    "algebra.js",
    "materials.js",
    "shapes.js",
    "stage.js",
    "actors.js",
    "camera.js",
    "words.js",
    "widgets.js",
    "cloud.js",
)
POINTS = 60_000  # that a page draws, unless told otherwise
STIFFNESS, DEFLECTION = ("softest", "stiffest"), ("least", "largest")
#: variable of a map → (label, unit that is shown, factor from SI, words for its two ends)
SHOWN = {
    "minimum_stiffness": ("least stiffness", "N/µm", 1e-6, STIFFNESS),
    "maximum_stiffness": ("greatest stiffness", "N/µm", 1e-6, STIFFNESS),
    "mean_stiffness": ("mean stiffness", "N/µm", 1e-6, STIFFNESS),
    "critical_load_factor": ("load factor at loss of stability", "", 1.0, STIFFNESS),
    "conditioning": ("singular-value ratio", "", 1.0, ("worst", "best")),
    "deflection_length": ("deflection", "µm", 1e6, DEFLECTION),
    "deflection_std_parameters": (
        "± of the deflection, from the parameters", "µm", 1e6, DEFLECTION,
    ),
    "deflection_std_remainder": (
        "± of the deflection, from what is unexplained", "µm", 1e6, DEFLECTION,
    ),
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class Cloud:
    """Points with a value each.

    Attributes:
        position: (N, 3) base axes [m].
        values: (N,) in `unit`.
        label, unit: What the values are.
        subtitle: What else the reader should know, the load for example.
        ends: What a small value is called, and a large one.
        axes: Name and unit of each number that tells where a point is.
        places: (N, len(axes)) those numbers.
        poses: (N, n) coordinates of the arm there [rad or m], or None.
    """

    position: Array
    values: Array
    label: str
    unit: str
    subtitle: str = ""
    ends: tuple[str, str] = STIFFNESS
    axes: Sequence[tuple[str, str]] = (("x", "mm"), ("y", "mm"), ("z", "mm"))
    places: Array | None = None
    poses: Array | None = None

    def __post_init__(self) -> None:
        if self.position.shape != (len(self.values), 3) or not len(self.values):
            raise InputError(f"{len(self.values)} values for points of shape {self.position.shape}")
        if self.places is None:
            object.__setattr__(self, "places", 1e3 * self.position)
        if self.told.shape != (len(self.values), len(self.axes)):
            raise InputError(f"{len(self.axes)} axes for places of shape {self.told.shape}")
        if not (np.isfinite(self.position).all() and np.isfinite(self.values).all()):
            raise InputError("a point or a value is not a finite number")

    @property
    def told(self) -> Array:
        """(N, len(axes)) numbers that tell where a point is."""
        return np.asarray(self.places)

    @property
    def weakest(self) -> int:
        """The point that a reader looks for: the softest, or that of the largest deflection."""
        return int(np.argmax(self.values) if self.ends is DEFLECTION else np.argmin(self.values))

    @property
    def best(self) -> int:
        """The point at the other end."""
        return int(np.argmin(self.values) if self.ends is DEFLECTION else np.argmax(self.values))

    def lead(self) -> str:
        """Where it is weakest and how much, in one sentence."""
        said = "; ".join(
            f"{text} {number(float(self.values[k]))} {self.unit}".strip() + place
            for k, text, place in zip(
                (self.weakest, self.best), self.marks, (f" at {self._where(self.weakest)}", ""),
                strict=True,
            )
        )  # fmt: skip
        return said[0].upper() + said[1:]

    @property
    def marks(self) -> tuple[str, str]:
        """What the weakest point is called, and the best."""
        return (self.ends[1], self.ends[0]) if self.ends is DEFLECTION else self.ends

    def _where(self, point: int) -> str:
        told = zip(self.axes, self.told[point], strict=True)
        return ", ".join(
            f"{name} {number(float(value))}{'' if unit == '°' else ' '}{unit}"
            for (name, unit), value in told
        )


def cloud_of_map(
    dataset: xarray.Dataset,
    robot: Robot,
    *,
    variable: str = "minimum_stiffness",
    load: int = 0,
    points: int = POINTS,
) -> Cloud:
    """Points of a map that have a value, evenly thinned out to about `points`.

    Args:
        dataset: A map, see `sk120stiff.workspace.open_map`.
        robot: The robot of the map: it says where the poses of a map over joints are.
        variable: One of `SHOWN`.
        load: Number of the load.

    Raises:
        InputError: There is no such variable or load, another robot, or no point has a value.
    """
    if variable not in SHOWN:
        raise InputError(
            f"{variable!r} is not shown as points", remedy=f"Choose from {', '.join(SHOWN)}."
        )
    if variable not in dataset:
        there = [name for name in SHOWN if name in dataset]
        raise InputError(
            f"this map holds no {variable!r}",
            remedy=f"It holds {', '.join(there)}. Deflections need a load, and their ± a model "
            "that 'identify' or 'explain' wrote.",
        )
    if not 0 <= load < dataset.sizes["load"]:
        raise InputError(f"the map has no load {load}", remedy=f"It has {dataset.sizes['load']}.")
    if tuple(dataset.attrs["joints"]) != robot.actuated:
        raise InputError(
            f"this map is of {dataset.attrs['robot']!r}, whose joints are others", where=robot.name
        )
    label, unit, factor, ends = SHOWN[variable]
    axes = [str(dim) for dim in dataset[variable].dims if dim != "load"]
    chosen = dataset[variable]
    chosen = chosen.isel(load=load) if "load" in chosen.dims else chosen
    every = factor * np.asarray(chosen.transpose(*axes).values, dtype=float)
    index = _thinned(every, points)
    values = every.ravel()[index]
    of_axes = np.unravel_index(index, every.shape)
    columns = {
        axis: np.asarray(dataset[axis].values, dtype=float)[k]
        for axis, k in zip(axes, of_axes, strict=True)
    }
    poses: Array | None = None
    told: dict[str, Any] = {}
    if set(axes) == {"x", "y", "z"}:
        position = np.stack([columns[name] for name in "xyz"], axis=1)
    else:
        a = np.tile(np.asarray(dataset.attrs["rest"], dtype=float), (len(values), 1))
        for axis, column in columns.items():
            a[:, robot.actuated.index(axis)] = column
        closes = robot.closes(a)
        poses, values = a[closes], values[closes]
        held = [robot.actuated.index(axis) for axis in axes]
        units = ["mm" if robot.prismatic[k] else "°" for k in held]
        scale = np.array([1e3 if robot.prismatic[k] else np.degrees(1.0) for k in held])
        told = {"axes": tuple(zip(axes, units, strict=True)), "places": poses[:, held] * scale}
        point = np.asarray(dataset.attrs["point"], dtype=float)
        position = robot.screws(poses, dataset.attrs["frame"], point).position
    known = np.isfinite(values)
    if not known.any():
        raise InputError("no point of this map has a value", where=variable)
    wrench = np.asarray(dataset["wrench"].isel(load=load).values, dtype=float)
    if poses is not None:
        told |= {"places": told["places"][known], "poses": poses[known]}
    said = load_in_words(wrench.tolist())
    return Cloud(position[known], values[known], label, unit, said, ends, **told)


def _thinned(every: Array, points: int) -> Index:
    """Flat indices of about so many values, evenly spread, the two extremes always among them."""
    flat = np.arange(every.size)
    wide = max(1, sum(n > 1 for n in every.shape))
    stride = max(1, int(np.ceil((every.size / points) ** (1.0 / wide))))
    spread = flat.reshape(every.shape)[tuple(slice(None, None, stride) for _ in every.shape)]
    ends = [np.nanargmin(every), np.nanargmax(every)] if np.isfinite(every).any() else []
    return np.unique(np.concatenate([spread.ravel(), np.array(ends, dtype=np.intp)]))


def cloud_html(scene: Scene, cloud: Cloud) -> str:
    """Text of a self-contained page: the robot among coloured points, where it is weakest.

    A map of positions does not keep poses; there it stands at the scene's first.
    """
    payload = scene_payload(scene, live=True)
    pose = scene.first_pose if cloud.poses is None else cloud.poses[cloud.weakest]
    request = Request(pose, np.zeros(6), np.asarray(scene.point, dtype=float))
    payload["links_at"] = frame_payload(compute_frame(scene.tree, scene.elastic, request))["links"]
    payload["cloud"] = _cloud_payload(cloud)
    return (
        environment()
        .get_template("cloud.html.j2")
        .render(
            title=scene.title or scene.robot.name,
            lead=cloud.lead(),
            subtitle=f"{cloud.label}, {cloud.subtitle}" if cloud.subtitle else cloud.label,
            payload=Markup(json_for_script(payload)),
            viewer=Markup(viewer_script()),
            scripts=[Markup(script(name)) for name in SCRIPTS],
            colours=Markup(palette.style_variables()),
        )
    )


def cloud_page(path: str | os.PathLike[str], scene: Scene, cloud: Cloud) -> Path:
    """Write the page of `cloud_html`."""
    return write_atomically(path, cloud_html(scene, cloud))


def _cloud_payload(cloud: Cloud) -> dict[str, Any]:
    values = np.asarray(cloud.values, dtype=np.float32)  # as the page sees them
    low, high = np.quantile(values, [0.01, 0.99])
    if not high > low:
        low, high = float(low) - 0.5, float(high) + 0.5
    stops = np.array([palette.channels(colour) for colour in palette.SOFT_TO_STIFF])
    stops = stops[::-1] if cloud.ends is DEFLECTION else stops
    share = np.linspace(0.0, 1.0, 256)
    of_stops = np.linspace(0.0, 1.0, len(stops))
    colours = np.stack([np.interp(share, of_stops, stop) for stop in stops.T], axis=1)
    return {
        "position": _packed(cloud.position),
        "values": _packed(cloud.values),
        "range": [float(values.min()), float(values.max())],
        "colour_range": [float(low), float(high)],
        "colours": np.round(colours, 4).tolist(),
        "axes": [{"name": name, "unit": unit} for name, unit in cloud.axes],
        "places": _packed(cloud.told),
        "marks": [
            {"point": cloud.weakest, "text": cloud.marks[0]},
            {"point": cloud.best, "text": cloud.marks[1]},
        ],
        "ends": list(cloud.ends),
        "label": cloud.label,
        "unit": cloud.unit,
    }


def _packed(values: Array) -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f4").tobytes()).decode("ascii")
