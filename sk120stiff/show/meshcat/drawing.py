"""The arm under load in Meshcat: into any `meshcat.Visualizer`, beside what is drawn there already.

Nothing is computed here: links, deflected shape and stiffness are those of `compute_frame`, sizes
those of the page that `sk120stiff view` opens.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError, require
from sk120stiff.robot import Robot
from sk120stiff.show import palette
from sk120stiff.show.scene.building import scene_of_model
from sk120stiff.show.scene.frame import Frame, Request, compute_frame
from sk120stiff.show.scene.payload import limits_of, scale_of
from sk120stiff.show.scene.scene import Reading, Scene
from sk120stiff.show.scene.shapes import Body, Colour, along, bodies_of
from sk120stiff.stiffness import POSITIONS

if TYPE_CHECKING:
    from sk120stiff.measurements import Measurements
    from sk120stiff.model import Model


GHOST: Final[Colour] = (*palette.channels(palette.SKY), 0.42)
ELLIPSOIDS: Final = {"compliance": palette.ENHANCED, "stiffness": palette.YELLOW}
ARROWS: Final = {
    "load": palette.LOAD,
    "moment": palette.NOISE,
    "measured": palette.MEASURED,
    "predicted": palette.PREDICTED,
    "gap": palette.GAP,
}
HALF, LONGEST = 0.13, 0.45  # usual and largest half axis of an ellipsoid, of the arm's reach
THIN = 0.0042  # radius of an arrow's shaft, of the arm's reach
FORCE = 0.22  # length of the largest load's arrow, of the arm's reach

Moves = dict[str, "Array | None"]


def in_meshcat(
    visualizer: Any,
    robot: Robot,
    pose: ArrayLike,
    wrench: ArrayLike = (0.0, 0.0, 0.0),
    *,
    model: Model | None = None,
    data: Measurements | None = None,
    root: str = "sk120stiff",
) -> InMeshcat:
    """Draw an arm under load: links, deflected shape, ellipsoids, load, and gaps.

    Under `root` stand ``arm`` and ``deflected`` (displacements exaggerated), ``compliance`` (long
    where it is soft) and ``stiffness`` (long where it is stiff) of the loaded point, the arrows
    ``load`` and ``moment``, and ``measured``, ``predicted`` and ``gap`` where a reading was taken
    at this pose under this load. What is drawn again under the same root is replaced.

    Args:
        visualizer: A `meshcat.Visualizer`, or Pinocchio's `MeshcatVisualizer`.
        robot: The rigid robot; its base frame is the origin.
        pose: (n,) actuated coordinates [rad or m].
        wrench: (3,) force [N] or (6,) force and moment [N·m] at the point, base axes.
        model: What yields; springs typical of such an arm where it is left out.
        data: Readings whose gaps are shown.
        root: Path of the drawing.

    Returns:
        InMeshcat: Its `update` moves the drawing, its `animate` plays a path.

    Raises:
        InputError: A shape does not fit, or model and data are of another robot.
        MissingPart: meshcat is not installed.

    Examples:
        >>> import meshcat, sk120stiff as sk                            # doctest: +SKIP
        >>> viewer = meshcat.Visualizer()                               # doctest: +SKIP
        >>> robot = sk.load_robot("motoman_sk120")                      # doctest: +SKIP
        >>> shown = sk.show.in_meshcat(viewer, robot, [0] * 6, [0, 0, -490])  # doctest: +SKIP
        >>> shown.update([0, 0.3, -0.4, 0, -1, 0], [0, 0, -490])        # doctest: +SKIP
    """
    from sk120stiff.model import base_model

    if model is not None and model.robot.name != robot.name:
        raise InputError(
            f"the model belongs to {model.robot.name}, not to {robot.name}",
            remedy="Give the robot of the model.",
        )
    scene = scene_of_model(model or base_model(robot), data, a=pose, wrench=_load(wrench))
    return InMeshcat(visualizer, scene, root=root)


class InMeshcat:
    """A scene that is drawn in a Meshcat viewer.

    Args:
        visualizer, root: See `in_meshcat`.
        scene: What is drawn; first at its first pose under its first load.

    Attributes:
        exaggeration: Factor on every displacement that is drawn.
        point: (3,) where the load acts, in the end frame [m].
    """

    def __init__(self, visualizer: Any, scene: Scene, *, root: str = "sk120stiff") -> None:
        require("meshcat", needed_for="Meshcat")
        self._top = getattr(visualizer, "viewer", visualizer)[root]
        self._scene = scene
        sizes = scale_of(scene)
        self._reach = float(sizes["reach"])
        self._thin = THIN * self._reach
        self._usual = sizes["references"]["translation"]
        self._largest = limits_of(scene)
        self.exaggeration = float(sizes["exaggeration"])
        self.point = np.asarray(scene.point, dtype=float)
        self._links = [f"{k}_{name.replace('/', '_')}" for k, name in enumerate(scene.tree.names)]
        self._build()
        self.update(scene.first_pose, scene.first_load)

    def update(self, pose: ArrayLike, wrench: ArrayLike) -> Frame:
        """Move the drawing to a pose (n,) under a load (3,) or (6,); what was computed.

        Raises:
            Refusal: The load is exactly critical, or the springs do not hold the arm.
        """
        frame = self._frame(pose, wrench)
        for path, T in self._moves(frame, pose, _load(wrench)).items():
            node = self._top[path]
            node.set_property("visible", T is not None)
            if T is not None:
                node.set_transform(T)
        return frame

    def animate(
        self,
        poses: ArrayLike,
        wrench: ArrayLike = (0.0, 0.0, 0.0),
        *,
        fps: int = 30,
        steps: int = 1,
        repetitions: int = 1,
    ) -> None:
        """Play a path: poses (N, n) under one load or one for each, (3,), (6,), (N, 3) or (N, 6).

        Args:
            fps: Frames per second.
            steps: Frames from one pose to the next; the viewer blends.
            repetitions: How often it is played.

        Raises:
            InputError: Another number of loads than of poses.
            Refusal: A pose does not hold its load.
        """
        from meshcat.animation import Animation
        from scipy.spatial.transform import Rotation

        path = np.atleast_2d(np.asarray(poses, dtype=float))
        loads = np.asarray(wrench, dtype=float)
        if loads.ndim == 2 and len(loads) != len(path):
            raise InputError(f"{len(loads)} loads for {len(path)} poses")
        played = Animation(default_framerate=fps)
        for k, pose in enumerate(path):
            load = _load(loads[k] if loads.ndim == 2 else loads)
            moves = self._moves(self._frame(pose, load), pose, load)
            for name, T in moves.items():
                with played.at_frame(self._top[name], k * steps) as at:
                    at.set_property("visible", "boolean", T is not None)
                    if T is not None:
                        scale = np.linalg.norm(T[:3, :3], axis=0)
                        turned = Rotation.from_matrix(T[:3, :3] / scale).as_quat().tolist()
                        at.set_property("position", "vector3", T[:3, 3].tolist())
                        at.set_property("quaternion", "quaternion", turned)
                        at.set_property("scale", "vector3", scale.tolist())
        self._top.set_animation(played, repetitions=repetitions)

    def _frame(self, pose: ArrayLike, wrench: ArrayLike) -> Frame:
        a = np.asarray(pose, dtype=float)
        request = Request(a, _load(wrench), self.point, self.exaggeration)
        return compute_frame(self._scene.tree, self._scene.elastic, request)

    def _build(self) -> None:
        """Every object once; later it only moves."""
        self._top.delete()
        for k, body in enumerate(bodies_of(self._scene.robot, self._scene.tree)):
            for group, colour in (("arm", body.colour), ("deflected", GHOST)):
                link = self._top[f"{group}/{self._links[body.link]}"]
                for part, (shape, T) in enumerate(solids(body)):
                    link[f"{k}_{part}"].set_object(shape, material(colour))
                    link[f"{k}_{part}"].set_transform(T)
        for name, shade in ELLIPSOIDS.items():
            self._top[name].set_object(unit_sphere(), material((*palette.channels(shade), 0.4)))
        for name, shade in ARROWS.items():
            paint = material((*palette.channels(shade), 1.0), over=True)
            for piece, (shape, T) in arrow(self._thin).items():
                self._top[f"{name}/{piece}"].set_object(shape, paint)
                self._top[f"{name}/{piece}"].set_transform(T)

    def _moves(self, frame: Frame, pose: ArrayLike, load: Array) -> Moves:
        """Path → where it stands now, None where there is nothing to see."""
        moves: Moves = {}
        bent = frame.deflected if load.any() else None
        for k, name in enumerate(self._links):
            moves[f"arm/{name}"] = frame.links[k]
            moves[f"deflected/{name}"] = None if bent is None else bent[k]
        found = frame.found
        place = found.of("position")
        axes = found.axes("enhanced", POSITIONS)
        holds = bool((axes.values > 0.0).all())  # an unstable direction has no ellipsoid
        for name, sizes in (("compliance", axes.values), ("stiffness", _inverse(axes.values))):
            halves = np.minimum(sizes * HALF / self._usual[name], LONGEST) * self._reach
            moves[name] = ellipsoid(place, axes.directions, halves) if holds else None
        longest = FORCE * self._reach
        arrows = {
            "load": load[:3] * longest / self._largest["force"],
            "moment": load[3:] * longest / self._largest["moment"],
        }
        start = {}
        reading = self._reading(np.asarray(pose, dtype=float), load)
        if reading is not None and reading.measured is not None:
            (predicted,) = reading.predicted.values()
            arrows["measured"] = self.exaggeration * reading.measured
            arrows["predicted"] = self.exaggeration * predicted
            arrows["gap"] = arrows["measured"] - arrows["predicted"]
            start["gap"] = place + arrows["predicted"]
        for name in ARROWS:
            vector = arrows.get(name, np.zeros(3))
            moves[name] = pointing(start.get(name, place), vector, self._thin)
        return moves

    def _reading(self, pose: Array, load: Array) -> Reading | None:
        """The reading that was taken at this pose under this load."""
        for each in self._scene.poses:
            if np.allclose(each.a, pose, rtol=0.0, atol=1e-9):
                for reading in each.readings:
                    point = self.point if reading.point is None else reading.point
                    same = np.allclose(point, self.point, rtol=0.0, atol=1e-9)
                    if same and np.allclose(reading.wrench, load, rtol=1e-9, atol=1e-9):
                        return reading
        return None


def _load(wrench: ArrayLike) -> Array:
    given = np.asarray(wrench, dtype=float)
    return np.concatenate([given, np.zeros(3)]) if given.shape == (3,) else given


def _inverse(values: Array) -> Array:
    with np.errstate(divide="ignore"):
        return np.asarray(1.0 / values)


# three.js has its cylinders along y.
_UP = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])


def ellipsoid(centre: Array, directions: Array, halves: Array) -> Array:
    """(4, 4) that makes the unit sphere an ellipsoid; rows of `directions` are its axes."""
    T = np.eye(4)
    T[:3, :3] = directions.T * np.maximum(halves, 1e-3 * halves.max())
    if np.linalg.det(T[:3, :3]) < 0.0:
        T[:3, 2] *= -1.0
    T[:3, 3] = centre
    return T


def pointing(start: Array, vector: Array, thin: float) -> Array | None:
    """(4, 4) that makes an arrow of length 1 along z this vector; None where nothing is to see.

    An arrow that is short beside its shaft's radius `thin` is thinner too.
    """
    length = float(np.linalg.norm(vector))
    if length < 0.05 * thin:
        return None
    T = along(vector)
    T[:3, :2] *= min(1.0, length / (20.0 * thin))
    T[:3, 2] *= length
    T[:3, 3] = start
    return T


def solids(body: Body) -> Iterator[tuple[Any, Array]]:
    """Meshcat's geometries of a body, each with its (4, 4) placement on the link."""
    from meshcat import geometry as g

    T = body.placement
    if body.mesh is not None:
        yield g.TriangularMeshGeometry(body.mesh.vertices, body.mesh.faces), T
    elif body.kind == "box":
        yield g.Box(list(body.size)), T
    elif body.kind == "sphere":
        yield g.Sphere(body.size[0]), T
    else:
        radius, length = body.size
        yield g.Cylinder(length, radius), T @ _UP
        for end in (-0.5, 0.5) if body.kind == "capsule" else ():
            shifted = T.copy()
            shifted[:3, 3] += end * length * T[:3, 2]
            yield g.Sphere(radius), shifted


def arrow(thin: float) -> dict[str, tuple[Any, Array]]:
    """Shaft and head of an arrow from the origin to z = 1."""
    from meshcat import geometry as g

    parts = {}
    for name, low, high, bottom, top in (
        ("shaft", 0.0, 0.85, thin, thin),
        ("head", 0.85, 1.0, 3.2 * thin, 0.0),
    ):
        T = _UP.copy()
        T[2, 3] = 0.5 * (low + high)
        parts[name] = (g.Cylinder(high - low, radiusTop=top, radiusBottom=bottom), T)
    return parts


def unit_sphere() -> Any:
    """What an ellipsoid is made from."""
    from meshcat.geometry import Sphere

    return Sphere(1.0)


def material(colour: Colour, *, over: bool = False) -> Any:
    """A surface of this colour and opacity; `over` what stands before it, as marks are drawn."""
    from meshcat.geometry import MeshBasicMaterial, MeshPhongMaterial

    red, green, blue = (round(255 * part) for part in colour[:3])
    opacity = float(colour[3])
    tint = (red << 16) + (green << 8) + blue
    if over:  # transparent things are drawn last
        return MeshBasicMaterial(color=tint, transparent=True, depthTest=False, depthWrite=False)
    return MeshPhongMaterial(
        color=tint, opacity=opacity, transparent=opacity < 1.0, depthWrite=opacity == 1.0
    )
