"""The roads that `bench.py` compares: the same work, done by different means.

The work, for every pose of a 6R arm under one force: Jacobian, K_C, the 3×3 compliance
J (K_θ − K_C)⁻¹ Jᵀ and its principal values. A road is a function that takes a number of seconds and
returns poses per second; it raises ImportError where its library is not installed.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from sk120stiff import load_robot
from sk120stiff.robot import Robot
from sk120stiff.stiffness import (
    cartesian_compliance,
    complementary_stiffness,
    principal_stiffness,
    spring_matrix,
    stiffness_batch,
)

FORCE = np.array([300.0, -200.0, 400.0, 0.0, 0.0, 0.0])
Array = np.ndarray[Any, np.dtype[np.float64]]


def serial_arm(joints: int = 6) -> Robot:
    """A serial arm with the lengths of a large industrial robot, without couplings."""
    axes = ("0 0 1", "0 1 0", "0 -1 0", "1 0 0", "0 -1 0", "1 0 0")
    origins = ("0 0 0", "0.215 0 0", "0 0 1.1", "1.3 0 0.25", "0 0 0", "0 0 0")
    links = "".join(f'<link name="l{k}"/>' for k in range(joints + 2))
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
    robot, a, K = serial_arm(joints), poses(count, joints), springs(joints)
    want = ("compliance", "values")
    return rate(
        lambda: stiffness_batch(robot, a, K, FORCE, want=want, threads=threads), count, seconds
    )


def numpy_arrays(seconds: float, *, count: int = 20_000, joints: int = 6) -> float:
    """The functions of sk120stiff.stiffness on whole arrays."""
    robot, a, K = serial_arm(joints), poses(count, joints), springs(joints)

    def work() -> object:
        screws = robot.screws(a)
        stiffness = spring_matrix(K) - complementary_stiffness(screws, FORCE)
        return principal_stiffness(cartesian_compliance(screws.linear_jacobian, stiffness)).values

    return rate(work, count, seconds)


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
    expected = stiffness_batch(serial_arm(), np.asarray(a[:8]), springs(), FORCE, want=("values",))
    if not np.allclose(np.sort(compiled(a[:8])), np.sort(expected.values), rtol=1e-6):
        raise RuntimeError("JAX was given another robot")
    return rate(lambda: compiled(a).block_until_ready(), count, seconds)


#: name → (function, what it says in the table)
ROADS: dict[str, tuple[Callable[..., float], str]] = {
    "kernel": (kernel, "sk120stiff batch kernel"),
    "numpy": (numpy_arrays, "sk120stiff functions on NumPy arrays"),
    "jax": (jax_arrays, "JAX on the CPU, jit and vmap"),
    "pinocchio": (pinocchio_loop, "Python loop over Pinocchio"),
    "roboticstoolbox": (roboticstoolbox_loop, "Python loop over roboticstoolbox (J and H only)"),
}
