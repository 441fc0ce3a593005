"""`sk120stiff view ROBOT`."""

from __future__ import annotations

from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING

from sk120stiff.cli.frame import Answer, note
from sk120stiff.cli.opening import model_file, model_for, open_model, pose_of, wrench_of
from sk120stiff.cli.options import (
    BaseOption,
    ModelOption,
    PoseOption,
    RobotOrModelArgument,
    ToolOption,
    WrenchOption,
)
from sk120stiff.cli.outputs import will_draw, will_show
from sk120stiff.errors import InputError

if TYPE_CHECKING:
    from sk120stiff.measurements import Measurements
    from sk120stiff.model import Model
    from sk120stiff.show import Scene

LOOPBACK = ("127.0.0.1", "localhost", "::1")


def command(
    robot: RobotOrModelArgument,
    model: ModelOption = None,
    data: Path | None = None,
    before: Path | None = None,
    pose: PoseOption = None,
    wrench: WrenchOption = None,
    static: Path | None = None,
    meshcat: bool = False,
    no_open: bool = False,
    port: int = 7400,
    host: str = "127.0.0.1",
    base: BaseOption = None,
    tool: ToolOption = None,
) -> Answer:
    """The robot, its ellipsoids and its gaps, live in the browser.

    Opens a page on this machine and runs until it is interrupted (Ctrl-C). The page has a slider
    for every motor and for the load. With --static it writes the page as a file and ends. With
    --meshcat the viewer is Meshcat's, which other programs can draw into at the address printed;
    with --data it plays the measured poses there.

    Example: sk120stiff view motoman_sk120 --wrench '0,0,-490 N' --static scene.html

    Args:
        data (DATA): Measurements (CSV) whose poses are listed, with measured and predicted arrows.
        before (MODEL): A second model, whose predictions are shown beside those of the first.
        static (FILE): Write the scene as one HTML file that works offline, instead of serving it.
        meshcat: Open Meshcat's own viewer instead, on this machine alone.
        no_open: Print the address without opening a browser.
        port (N): First port to try; 0 takes any that is free.
        host (ADDRESS): Address to listen on. Anything but loopback shows the page to your network.
    """
    will_show(static, "--static")
    will_draw(robot)
    measured = None if data is None else _read(data)
    if measured is not None:  # the frames that the readings are about
        base, tool = base or measured.base_frame, tool or measured.tool_frame
    believed = open_model(robot, model, base=base, tool=tool)
    file = model or model_file(robot)
    scene = _scene(believed, file, before, measured, pose, wrench)
    if meshcat:
        _refuse_beside_meshcat(static, before, host)
        return _in_meshcat(scene, no_open=no_open)
    if static is not None:
        from sk120stiff.show import static_scene

        written = static_scene(static, scene)
        document = {"url": written.resolve().as_uri(), "scene": str(written)}
        return Answer(document, parts=[f"Scene: {written}"])
    from sk120stiff.show.live import LiveServer

    server = LiveServer(scene, host=host, port=port)
    if host not in LOOPBACK:
        note(f"Everyone who can reach {host} can see this page.")
    parts = [f"Open {server.url}", "Ctrl-C ends it."]
    return Answer(
        {"url": server.url}, parts, afterwards=lambda: server.serve(open_browser=not no_open)
    )


def _read(data: Path) -> Measurements:
    from sk120stiff.measurements import read_measurements

    return read_measurements(data)


def _scene(
    model: Model,
    file: Path | None,
    before: Path | None,
    data: Measurements | None,
    pose: str | None,
    wrench: str | None,
) -> Scene:
    from sk120stiff.show import scene_of_model

    robot = model.robot
    shown = {} if before is None else {"before": model_for(robot, before)}
    return scene_of_model(
        model,
        data,
        models={**shown, "model": model},
        title=robot.name,
        a=None if pose is None else pose_of(robot, pose),
        wrench=None if wrench is None else wrench_of(wrench),
        model_file=file or "",
    )


def _refuse_beside_meshcat(static: Path | None, before: Path | None, host: str) -> None:
    for option, given in (("--static", static), ("--before", before)):
        if given is not None:
            raise InputError(f"--meshcat and {option} exclude each other", remedy="Leave one out.")
    if host not in LOOPBACK:
        raise InputError(
            "Meshcat's own server guards nothing and stays on loopback",
            where=f"--host {host}",
            remedy="Leave --host out, or --meshcat.",
        )


def _in_meshcat(scene: Scene, *, no_open: bool) -> Answer:
    from sk120stiff.show.meshcat import InMeshcat
    from sk120stiff.show.meshcat.bridge import meshcat_on_loopback

    viewer = meshcat_on_loopback()
    shown = InMeshcat(viewer, scene)
    visited = [pose for pose in scene.poses if pose.readings]
    if len(visited) > 1:
        loads = [pose.readings[-1].wrench for pose in visited]
        shown.animate([pose.a for pose in visited], loads, steps=30, repetitions=10)
    address = {"url": viewer.url(), "zmq_url": viewer.window.zmq_url}

    def stay() -> None:
        if not no_open:
            viewer.open()
        Event().wait()

    parts = [f"Open {address['url']}", f"Draw into it at {address['zmq_url']}", "Ctrl-C ends it."]
    return Answer(address, parts, afterwards=stay)
