"""The roads that `bench.py` compares: the same work, done by different means.

The work, for every pose of a 6R arm under one force: Jacobian, K_C, the 3×3 compliance
J (K_θ − K_C)⁻¹ Jᵀ and its principal values. A road is a function that takes a number of seconds and
returns poses per second; it raises ImportError where its library is not installed.
"""

from __future__ import annotations

import hashlib
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from sk120stiff import load_robot
from sk120stiff.robot import Robot
from sk120stiff.stiffness import ConstantCompliance, under_load
from sk120stiff.stiffness.on_arrays import on_arrays

FORCE = np.array([300.0, -200.0, 400.0, 0.0, 0.0, 0.0])
Array = np.ndarray[Any, np.dtype[np.float64]]


def serial_arm(joints: int = 6, mass: float = 0.0) -> Robot:
    """A serial arm with the lengths of a large industrial robot, without couplings.

    Every link has its mass [kg] 0.2 m off its joint.
    """
    axes = ("0 0 1", "0 1 0", "0 -1 0", "1 0 0", "0 -1 0", "1 0 0")
    origins = ("0 0 0", "0.215 0 0", "0 0 1.1", "1.3 0 0.25", "0 0 0", "0 0 0")
    heavy = (
        f'<inertial><origin xyz="0.2 0 0"/><mass value="{mass}"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    )
    inside = heavy if mass else ""
    links = "".join(f'<link name="l{k}">{inside}</link>' for k in range(joints + 2))
    moving = "".join(
        f'<joint name="j{k}" type="revolute"><parent link="l{k}"/><child link="l{k + 1}"/>'
        f'<origin xyz="{origins[k % 6]}"/><axis xyz="{axes[k % 6]}"/>'
        '<limit lower="-3.1" upper="3.1" effort="0" velocity="0"/></joint>'
        for k in range(joints)
    )
    flange = (
        f'<joint name="f" type="fixed"><parent link="l{joints}"/><child link="l{joints + 1}"/>'
        '<origin xyz="0.35 0.1 0.2"/></joint>'
    )
    return load_robot(f'<robot name="serial_{joints}">{links}{moving}{flange}</robot>')


def poses(count: int, joints: int = 6) -> Array:
    """Random poses, the same ones for every road."""
    return np.random.default_rng(0).uniform(-1.5, 1.5, (count, joints))


def springs(joints: int = 6) -> Array:
    """Springs of industrial size [N·m/rad]."""
    return np.linspace(1.4e6, 4e5, joints)


def elastic_arm(joints: int = 6, mass: float = 0.0) -> ConstantCompliance:
    """The arm on its springs, hanging by its weight where its links have a mass [kg]."""
    robot = serial_arm(joints, mass)
    gravity = robot.gravity_in_base if mass else None
    return ConstantCompliance.of_springs(robot, springs(joints), gravity=gravity)


def rate(work: Callable[[], object], count: int, seconds: float) -> float:
    """Poses per second: the best of as many runs as fit into the time, at least three."""
    work()
    best, end, runs = np.inf, time.perf_counter() + seconds, 0
    while runs < 3 or time.perf_counter() < end:
        start = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - start)
        runs += 1
    return count / best


def kernel(seconds: float, *, threads: int = 1, count: int = 400_000, joints: int = 6) -> float:
    """The compiled batch kernel."""
    arm, a = elastic_arm(joints), poses(count, joints)
    want = ("compliance", "values")
    return rate(lambda: under_load(arm, a, FORCE, want, threads=threads), count, seconds)


def kernel_sagging(seconds: float, *, count: int = 200_000) -> float:
    """The compiled kernel for an arm that sags under its own weight before the load comes."""
    arm, a = elastic_arm(mass=100.0), poses(count)
    want = ("compliance", "values")
    return rate(lambda: under_load(arm, a, FORCE, want, threads=1), count, seconds)


def numpy_arrays(seconds: float, *, count: int = 20_000, joints: int = 6) -> float:
    """The same call on NumPy arrays, without the kernel."""
    arm, a = elastic_arm(joints), poses(count, joints)
    return rate(lambda: on_arrays(arm, a, FORCE, ("compliance", "values")), count, seconds)


def pinocchio_loop(seconds: float, *, count: int = 2_000) -> float:
    """A Python loop over Pinocchio's Jacobian, the rest in NumPy, one pose at a time."""
    import pinocchio as pin

    model = pin.buildModelFromXML(serial_arm().document.xml)
    data = model.createData()
    frame = model.getFrameId("l7")
    a, K_theta = poses(count), np.diag(springs())
    fx, fy, fz = FORCE[:3]
    cross = np.array([[0, -fz, fy], [fz, 0, -fx], [-fy, fx, 0]])
    upper, strict = np.triu(np.ones((6, 6))), np.triu(np.ones((6, 6)), 1)

    def work() -> object:
        values = np.empty((count, 3))
        for k in range(count):
            J = pin.computeFrameJacobian(model, data, a[k], frame, pin.LOCAL_WORLD_ALIGNED)
            v = J[:3]
            product = (cross @ J[3:]).T @ v
            K = K_theta - product * upper - (product * strict).T
            values[k] = 1.0 / np.linalg.eigvalsh(v @ np.linalg.solve(K, v.T))
        return values

    return rate(work, count, seconds)


def pinocchio_vectorised(seconds: float, *, count: int = 20_000) -> float:
    """The same loop for the Jacobian alone; all that follows is done on whole arrays."""
    import pinocchio as pin

    model = pin.buildModelFromXML(serial_arm().document.xml)
    data = model.createData()
    frame = model.getFrameId("l7")
    a, K_theta, fx, fy, fz = poses(count), np.diag(springs()), *FORCE[:3]
    cross = np.array([[0, -fz, fy], [fz, 0, -fx], [-fy, fx, 0]])
    upper, strict = np.triu(np.ones((6, 6))), np.triu(np.ones((6, 6)), 1)

    def work() -> object:
        J = np.empty((count, 6, 6))
        for k in range(count):
            J[k] = pin.computeFrameJacobian(model, data, a[k], frame, pin.LOCAL_WORLD_ALIGNED)
        v = J[:, :3]
        product = np.swapaxes(cross @ J[:, 3:], 1, 2) @ v
        K = K_theta - product * upper - np.swapaxes(product * strict, 1, 2)
        return 1.0 / np.linalg.eigvalsh(v @ np.linalg.solve(K, np.swapaxes(v, 1, 2)))

    return rate(work, count, seconds)


def pinocchio_cpp(seconds: float, *, count: int = 100_000) -> float:
    """A plain C++ loop over Pinocchio, `peers/pinocchio_loop.cpp`, built for this processor."""
    compiler = next((c for c in ("c++", "g++", "clang++") if shutil.which(c)), None)
    if compiler is None:
        raise ImportError("no C++ compiler")
    prefix = next((p for p in _prefixes() if (p / "include/pinocchio").is_dir()), None)
    if prefix is None:
        raise ImportError("no headers of Pinocchio beside its library")
    places = [prefix / "include/eigen3", Path("/usr/include/eigen3"), Path("/usr/local/include")]
    eigen = next((p for p in places if (p / "Eigen/Dense").exists()), None)
    if eigen is None:
        raise ImportError("no headers of Eigen: pip install cmeel-eigen")
    chain, a = serial_arm().mechanism().chain, poses(count)
    numbers = [[*chain.placements[k][:3].ravel(), *chain.axes[k]] for k in range(chain.m)]
    numbers.append([*chain.placements[-1][:3].ravel()])
    source = Path(__file__).parent / "peers/pinocchio_loop.cpp"
    digest = hashlib.sha256(source.read_bytes() + str(prefix).encode()).hexdigest()[:12]
    program = Path.home() / ".cache/sk120stiff-bench" / f"pinocchio_loop_{digest}"
    if not program.exists():
        _build(program, source, compiler, prefix, eigen)
    with tempfile.TemporaryDirectory() as name:
        arm, inputs, outputs = (Path(name) / x for x in ("arm", "poses", "values"))
        arm.write_text("\n".join(" ".join(repr(float(x)) for x in row) for row in numbers))
        a.tofile(inputs)
        done = subprocess.run(
            [str(program), str(arm), str(inputs), str(seconds), str(outputs)],
            capture_output=True, text=True, check=True,
        )  # fmt: skip
        values = np.fromfile(outputs).reshape(-1, 3)
    expected = under_load(elastic_arm(), a, FORCE, ("values",)).of("values")
    if not np.allclose(values, expected, rtol=1e-8):
        raise RuntimeError("the C++ loop was given another robot")
    return float(done.stdout)


def _build(program: Path, source: Path, compiler: str, prefix: Path, eigen: Path) -> None:
    """Compile once; later runs find the program."""
    program.parent.mkdir(parents=True, exist_ok=True)
    # Pinocchio's list of joints is longer than Boost's usual limit.
    limits = ["-DBOOST_MPL_LIMIT_LIST_SIZE=30", "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS"]
    built = subprocess.run(
        [compiler, "-std=c++17", "-O3", "-march=native", "-DNDEBUG", *limits,
         f"-I{prefix / 'include'}", f"-I{eigen}", str(source), "-o", f"{program}.new",
         f"-L{prefix / 'lib'}", "-lpinocchio_default", f"-Wl,-rpath,{prefix / 'lib'}"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    if built.returncode:
        said = [line for line in built.stderr.splitlines() if "error" in line] or ["no message"]
        raise ImportError(f"the C++ loop is not built: {said[0][-120:]}")
    Path(f"{program}.new").rename(program)


def _prefixes() -> list[Path]:
    """Folders in which Pinocchio's wheel, or a system package, puts headers and libraries."""
    import pinocchio

    return [*Path(pinocchio.__file__).parents, Path("/opt/openrobots"), Path("/usr")]


def frax_arrays(seconds: float, *, count: int = 20_000) -> float:
    """frax's Jacobian (JAX on the CPU, double precision), and the same formulas after it."""
    import jax

    jax.config.update("jax_enable_x64", True)
    import jax.numpy as jnp
    from frax.core.manipulator import Manipulator

    robot = serial_arm(mass=1.0)  # frax wants an inertia of every link
    with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
        file.write(robot.document.xml)
        file.flush()
        arm = Manipulator(file.name, ee_offset=robot.mechanism().chain.placements[-1])
    K_theta, force = jnp.diag(jnp.array(springs())), jnp.array(FORCE[:3])

    def one(q: Any) -> Any:
        J = arm.ee_jacobian(q)
        v, w = J[:3], J[3:]
        product = jnp.cross(force, w.T) @ v
        K = K_theta - jnp.triu(product) - jnp.triu(product, 1).T
        return 1.0 / jnp.linalg.eigvalsh(v @ jnp.linalg.solve(K, v.T))

    compiled = jax.jit(jax.vmap(one))
    a = jnp.array(poses(count))
    expected = under_load(elastic_arm(), np.asarray(a[:8]), FORCE, ("values",)).of("values")
    if not np.allclose(np.sort(compiled(a[:8])), np.sort(expected), rtol=1e-6):
        raise RuntimeError("frax was given another robot")
    return rate(lambda: compiled(a).block_until_ready(), count, seconds)


def roboticstoolbox_loop(seconds: float, *, count: int = 2_000) -> float:
    """A Python loop over roboticstoolbox's jacob0 and hessian0 alone: part of the work only."""
    import roboticstoolbox as rtb
    from spatialmath import SE3

    chain = serial_arm().mechanism().chain
    ets = rtb.ETS()
    for k in range(chain.m):
        ets = ets * rtb.ET.SE3(SE3(chain.placements[k], check=False))
        axis = int(np.argmax(np.abs(chain.axes[k])))
        turn = (rtb.ET.Rx, rtb.ET.Ry, rtb.ET.Rz)[axis]
        ets = ets * turn(flip=bool(chain.axes[k][axis] < 0))
    ets = ets * rtb.ET.SE3(SE3(chain.placements[-1], check=False))
    a = poses(count)
    ours = serial_arm().jacobian(a[0])
    if not np.allclose(ets.jacob0(a[0]), ours, atol=1e-9):
        raise RuntimeError("roboticstoolbox was given another robot")

    def work() -> None:
        for row in a:
            ets.jacob0(row)
            ets.hessian0(row)

    return rate(work, count, seconds)


def jax_arrays(seconds: float, *, count: int = 100_000) -> float:
    """JAX on the CPU: jit and vmap of the same formulas, double precision."""
    import jax
    import jax.numpy as jnp

    jax.config.update("jax_enable_x64", True)
    chain = serial_arm().mechanism().chain
    placements, axes = jnp.array(chain.placements), np.array(chain.axes)
    K_theta, force = jnp.diag(jnp.array(springs())), jnp.array(FORCE[:3])

    def one(q: Any) -> Any:
        T = jnp.eye(4)
        turned, origins = [], []
        for k in range(chain.m):
            T = T @ placements[k]
            x, y, z = axes[k]
            skew = jnp.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
            turned.append(T[:3, :3] @ axes[k])
            origins.append(T[:3, 3])
            turn = jnp.eye(3) + jnp.sin(q[k]) * skew + (1 - jnp.cos(q[k])) * skew @ skew
            T = T.at[:3, :3].set(T[:3, :3] @ turn)
        point = (T @ placements[chain.m])[:3, 3]
        w = jnp.stack(turned)
        v = jnp.cross(w, point - jnp.stack(origins))
        product = jnp.cross(force, w) @ v.T
        K = K_theta - jnp.triu(product) - jnp.triu(product, 1).T
        return 1.0 / jnp.linalg.eigvalsh(v.T @ jnp.linalg.solve(K, v))

    compiled = jax.jit(jax.vmap(one))
    a = jnp.array(poses(count))
    expected = under_load(elastic_arm(), np.asarray(a[:8]), FORCE, ("values",)).of("values")
    if not np.allclose(np.sort(compiled(a[:8])), np.sort(expected), rtol=1e-6):
        raise RuntimeError("JAX was given another robot")
    return rate(lambda: compiled(a).block_until_ready(), count, seconds)


#: name → (function, what it says in the table)
ROADS: dict[str, tuple[Callable[..., float], str]] = {
    "kernel": (kernel, "sk120stiff batch kernel"),
    "kernel_sagging": (kernel_sagging, "sk120stiff batch kernel, arm sagging under its weight"),
    "numpy": (numpy_arrays, "sk120stiff on NumPy arrays"),
    "jax": (jax_arrays, "JAX on the CPU, jit and vmap"),
    "frax": (frax_arrays, "frax (JAX on the CPU), jit and vmap"),
    "pinocchio_cpp": (pinocchio_cpp, "plain C++ loop over Pinocchio"),
    "pinocchio_vectorised": (
        pinocchio_vectorised,
        "Python loop over Pinocchio's Jacobian, the rest vectorised",
    ),
    "pinocchio": (pinocchio_loop, "Python loop over Pinocchio"),
    "roboticstoolbox": (roboticstoolbox_loop, "Python loop over roboticstoolbox (J and H only)"),
}
