"""Pictures of a robot under load: figures, the report, the 3-D scene, the live page.

Nothing heavy is imported before a name is used. The parts:

Figures (`sk120stiff.show.figures`)
    Functions of plain arrays that return a matplotlib `Figure`, in one style:
    `force_deflection`, `surface_parts`, `relief_parts`, `stiffness_slice`,
    `plane_ellipses`, `gap_per_pose`, `gap_waterfall`, `parameter_forest`,
    `definiteness_map`, `posture_choice`.
    ``save_figure(fig, path)`` writes SVG, PNG or PDF by the ending of the name;
    ``inline_svg(fig, alt)`` gives the `<svg>` text for a page.

Report (`sk120stiff.show.report`)
    ``Report(title, sections=[Section(title, blocks=[...])], ...).write(path)``. Blocks are strings
    (paragraphs) and `Table`, `Picture`, `KeyFigures`, `Note`, `Items`, `Code`, `SceneFrame`,
    `Section` (a subsection). One file, readable offline, prints to PDF.

Scene (`sk120stiff.show.scene`)
    ``scene_of_model(model, data, models={"before": m0, "after": m1})``, or by hand
    ``Scene(robot, elastic=Elastic.of_model(model), poses=[ScenePose(...)])``; then
    ``static_scene(path, scene)`` for a self-contained page with sliders, ``scene_html(scene)`` for
    its text, and the scene itself shows in a notebook.

Map (`sk120stiff.show.scene.cloud`)
    ``cloud_page(path, scene, cloud_of_map(open_map("map.zarr"), robot))``: the robot among the
    coloured points of a map. ``figures_of_map(dataset)``: slices of it as figures.

Meshcat (`sk120stiff.show.meshcat`)
    ``in_meshcat(visualizer, robot, pose, wrench, model=model)`` draws into a `meshcat.Visualizer`,
    Pinocchio's among them; what it returns moves and plays.

Live (`sk120stiff.show.live`)
    ``LiveServer(scene, port=...).serve(open_browser=...)``: the same page with everything computed
    by Python.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sk120stiff.show.figures.of_map import MapFigure, figures_of_map
    from sk120stiff.show.figures.saving import inline_svg, save_figure
    from sk120stiff.show.meshcat import InMeshcat, in_meshcat
    from sk120stiff.show.report import (
        Code,
        Items,
        KeyFigure,
        KeyFigures,
        Note,
        Picture,
        Report,
        SceneFrame,
        Section,
        Table,
        reproducibility,
    )
    from sk120stiff.show.scene.building import scene_of_model
    from sk120stiff.show.scene.cloud import Cloud, cloud_html, cloud_of_map, cloud_page
    from sk120stiff.show.scene.elastic import Elastic
    from sk120stiff.show.scene.scene import Reading, Scene, ScenePose
    from sk120stiff.show.scene.static import scene_html, static_scene

_HOME = {
    name: home
    for home, names in {
        "figures.of_map": "MapFigure figures_of_map",
        "figures.saving": "inline_svg save_figure",
        "meshcat": "InMeshcat in_meshcat",
        "report": "Code Items KeyFigure KeyFigures Note Picture Report SceneFrame Section Table "
        "reproducibility",
        "scene.building": "scene_of_model",
        "scene.cloud": "Cloud cloud_html cloud_of_map cloud_page",
        "scene.elastic": "Elastic",
        "scene.scene": "Reading Scene ScenePose",
        "scene.static": "scene_html static_scene",
    }.items()
    for name in names.split()
}

__all__ = [
    "Cloud",
    "Code",
    "Elastic",
    "InMeshcat",
    "Items",
    "KeyFigure",
    "KeyFigures",
    "MapFigure",
    "Note",
    "Picture",
    "Reading",
    "Report",
    "Scene",
    "SceneFrame",
    "ScenePose",
    "Section",
    "Table",
    "cloud_html",
    "cloud_of_map",
    "cloud_page",
    "figures_of_map",
    "in_meshcat",
    "inline_svg",
    "reproducibility",
    "save_figure",
    "scene_html",
    "scene_of_model",
    "static_scene",
]


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
    globals()[name] = value
    return value
