"""A map as coloured points around the robot, in a self-contained page for the browser."""

from __future__ import annotations

import base64
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from markupsafe import Markup

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError, require
from sk120stiff.files import write_atomically
from sk120stiff.show import palette
from sk120stiff.show.scene.frame import Request, compute_frame
from sk120stiff.show.scene.payload import frame_payload, scene_payload
from sk120stiff.show.scene.scene import Scene
from sk120stiff.show.scene.static import environment, json_for_script, script, viewer_script
from sk120stiff.show.wording import load_in_words

if TYPE_CHECKING:
    import xarray

    from sk120stiff.robot import Robot

SCRIPTS = (
    "algebra.js",
    "materials.js",
    "shapes.js",
    "stage.js",
    "camera.js",
    "widgets.js",
    "cloud.js",
)
POINTS = 60_000  # that a page draws, unless told otherwise
#: variable of a map → (label, unit that is shown, factor from SI)
SHOWN = {
    "minimum_stiffness": ("least stiffness", "N/µm", 1e-6),
    "maximum_stiffness": ("greatest stiffness", "N/µm", 1e-6),
    "mean_stiffness": ("mean stiffness", "N/µm", 1e-6),
    "critical_load_factor": ("load factor at loss of stability", "", 1.0),
    "conditioning": ("singular-value ratio", "", 1.0),
    "deflection_length": ("deflection", "µm", 1e6),
    "deflection_std_parameters": ("± of the deflection, from the parameters", "µm", 1e6),
    "deflection_std_remainder": ("± of the deflection, from what is unexplained", "µm", 1e6),
}


@dataclass(frozen=True, eq=False)
class Cloud:
    """Points with a value each.

    Attributes:
        position: (N, 3) base axes [m].
        values: (N,) in `unit`.
        label, unit: What the values are.
        subtitle: What else the reader should know, the load for example.
    """

    position: Array
    values: Array
    label: str
    unit: str
    subtitle: str = ""

    def __post_init__(self) -> None:
        if self.position.shape != (len(self.values), 3) or not len(self.values):
            raise InputError(f"{len(self.values)} values for points of shape {self.position.shape}")
        if not (np.isfinite(self.position).all() and np.isfinite(self.values).all()):
            raise InputError("a point or a value is not a finite number")


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
    label, unit, factor = SHOWN[variable]
    axes = [str(dim) for dim in dataset[variable].dims if dim != "load"]
    sizes = np.array([dataset.sizes[axis] for axis in axes])
    stride = max(1, int(np.ceil((sizes.prod() / points) ** (1.0 / max(1, (sizes > 1).sum())))))
    part = dataset.isel({axis: slice(None, None, stride) for axis in axes})
    chosen = part[variable].isel(load=load) if "load" in part[variable].dims else part[variable]
    values = factor * np.asarray(chosen.values, dtype=float).ravel()
    grid = np.meshgrid(*(part[axis].values for axis in axes), indexing="ij")
    columns = {axis: each.ravel() for axis, each in zip(axes, grid, strict=True)}
    if set(axes) == {"x", "y", "z"}:
        position = np.stack([columns[name] for name in "xyz"], axis=1)
    else:
        a = np.tile(np.asarray(dataset.attrs["rest"], dtype=float), (len(values), 1))
        for axis, column in columns.items():
            a[:, robot.actuated.index(axis)] = column
        closes = robot.closes(a)
        a, values = a[closes], values[closes]
        point = np.asarray(dataset.attrs["point"], dtype=float)
        position = robot.screws(a, dataset.attrs["frame"], point).position
    known = np.isfinite(values)
    if not known.any():
        raise InputError("no point of this map has a value", where=variable)
    wrench = np.asarray(dataset["wrench"].isel(load=load).values, dtype=float)
    return Cloud(position[known], values[known], label, unit, load_in_words(wrench.tolist()))


def cloud_html(scene: Scene, cloud: Cloud) -> str:
    """Text of a self-contained page: the robot at the scene's first pose among coloured points."""
    payload = scene_payload(scene, live=True)
    request = Request(scene.first_pose, np.zeros(6), np.asarray(scene.point, dtype=float))
    payload["links_at"] = frame_payload(compute_frame(scene.tree, scene.elastic, request))["links"]
    payload["cloud"] = _cloud_payload(cloud)
    return (
        environment()
        .get_template("cloud.html.j2")
        .render(
            title=scene.title or scene.robot.name,
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
    require("matplotlib", needed_for="a picture")
    import matplotlib as mpl

    values = np.asarray(cloud.values, dtype=np.float32)  # as the page sees them
    low, high = np.quantile(values, [0.01, 0.99])
    if not high > low:
        low, high = float(low) - 0.5, float(high) + 0.5
    colours = mpl.colormaps["cividis"](np.linspace(0.0, 1.0, 256))[:, :3]
    return {
        "position": _packed(cloud.position),
        "values": _packed(cloud.values),
        "range": [float(values.min()), float(values.max())],
        "colour_range": [float(low), float(high)],
        "colours": np.round(colours, 4).tolist(),
        "label": cloud.label,
        "unit": cloud.unit,
    }


def _packed(values: Array) -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f4").tobytes()).decode("ascii")
