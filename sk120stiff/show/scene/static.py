"""The scene as one HTML file that opens from a disk, without a network and without Python."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable, Mapping
from functools import cache
from html import escape
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from sk120stiff.errors import InputError, require
from sk120stiff.files import write_atomically
from sk120stiff.show import palette
from sk120stiff.show.scene.payload import scene_payload
from sk120stiff.show.scene.scene import Scene

#: Order matters: each file uses what the ones before it define.
SCRIPTS = (
    "algebra.js",
    "engine.js",
    "socket.js",
    "materials.js",
    "shapes.js",
    "stage.js",
    "actors.js",
    "path.js",
    "camera.js",
    "words.js",
    "widgets.js",
    "readouts.js",
    "panel.js",
    "app.js",
)


def scene_html(scene: Scene) -> str:
    """Text of a self-contained page: Meshcat, the robot, and the kinematics to move it."""
    return render_page(scene_payload(scene), viewer=viewer_script())


def static_scene(path: str | os.PathLike[str], scene: Scene) -> Path:
    """Write the self-contained page of a scene."""
    return write_atomically(path, scene_html(scene))


def notebook_html(scene: Scene) -> str:
    """The scene for a notebook cell: the whole page inside an iframe, also in a saved notebook."""
    page = escape(scene_html(scene), quote=True)
    title = escape(scene.title or scene.robot.name, quote=True)
    return (
        f'<iframe title="{title}" srcdoc="{page}" '
        'style="width:100%;height:620px;border:0;border-radius:12px"></iframe>'
    )


def render_page(payload: dict[str, Any], *, viewer: str | None) -> str:
    """The page around a payload.

    Args:
        viewer: Meshcat's script to put into the page; None lets the page load it from the live
            server.
    """
    return (
        environment()
        .get_template("page.html.j2")
        .render(
            title=payload["title"],
            subtitle=payload["subtitle"],
            payload=Markup(json_for_script(payload)),
            viewer=None if viewer is None else Markup(viewer),
            scripts=[Markup(script(name)) for name in SCRIPTS],
            colours=Markup(palette.style_variables()),
        )
    )


def json_for_script(payload: object) -> str:
    """JSON that cannot end the `<script>` element it stands in.

    Raises:
        InputError: A number of it is not finite: something in the input overflows.
    """
    try:
        text = json.dumps(payload, allow_nan=False, separators=(",", ":"))
    except ValueError as error:
        raise InputError(
            "a number of this picture is not finite, because a length, mass or load is too large",
            where=_not_finite(payload) or None,
            remedy="Look for extreme numbers in the robot, the model and the load.",
        ) from error
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


def _not_finite(value: object, key: str = "") -> str:
    """The key of the first number that is not finite."""
    if isinstance(value, float):
        return "" if math.isfinite(value) else key
    items: Iterable[tuple[object, object]] = ()
    if isinstance(value, Mapping):
        items = value.items()
    elif isinstance(value, list | tuple):
        items = enumerate(value)
    inside = (_not_finite(part, f"{key}.{name}" if key else str(name)) for name, part in items)
    return next((found for found in inside if found), "")


@cache
def script(name: str) -> str:
    """One of our own scripts."""
    return (files("sk120stiff.show.scene") / "page" / name).read_text(encoding="utf-8")


@cache
def viewer_script() -> str:
    """Meshcat's viewer as it lies in the installed package."""
    # Importing meshcat would start ZeroMQ; the script alone is needed.
    require("meshcat", needed_for="the 3-D scene")
    found: Any = find_spec("meshcat")
    source = Path(found.submodule_search_locations[0]) / "viewer" / "dist" / "main.min.js"
    return source.read_text(encoding="utf-8").replace("</script", "<\\/script")


@cache
def environment() -> Environment:
    """The templates of pages with a 3-D scene."""
    return Environment(
        loader=PackageLoader("sk120stiff.show.scene", "page"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
