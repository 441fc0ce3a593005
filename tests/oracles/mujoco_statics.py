"""Static equilibrium of any MuJoCo model of hinges, slides and equality constraints.

Forces, constraint residuals and their Jacobians are MuJoCo's; only the search for the rest is
ours: Newton on (generalised force + constraint force = 0, constraint residual = 0), with the
tangent by finite differences. So constraints are hard, where time stepping leaves them soft.
`settle` steps time instead and shows that the rest is a stable one.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from tests.oracles.numpy_kinematics import rotation_vector

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Deflection:
    """Loaded minus unloaded, in world axes."""

    displacement: Array  # (3,) [m]
    rotation: Array  # (3,) rotation vector [rad]
    position: Array  # (3,) loaded position [m]
    unloaded: Array  # (4, 4) pose of the site without load
    qpos: Array  # (nq,) loaded coordinates
    closure: float  # largest residual of the equality constraints [m]


class Statics:
    """A model, the coordinates at which its springs are relaxed, and a loaded site `tip`."""

    def __init__(self, xml: str, relaxed: dict[str, float]) -> None:
        self.model = mujoco.MjModel.from_xml_string(xml)
        self.data = mujoco.MjData(self.model)
        self.site = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_SITE, "tip")
        if self.model.nq != self.model.nv:
            raise NotImplementedError("hinges and slides only")
        self.relaxed = np.zeros(self.model.nq)
        for name, value in relaxed.items():
            self.relaxed[self.model.joint(name).qposadr[0]] = value

    def _forward(self, qpos: Array, wrench: Array) -> Array:
        """Spring plus applied generalised force (nv,) at rest in `qpos`."""
        model, data = self.model, self.data
        data.qpos[:] = qpos
        data.qvel[:] = 0.0
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        applied = np.zeros(model.nv)
        mujoco.mj_applyFT(
            model,
            data,
            wrench[:3],
            wrench[3:],
            data.site_xpos[self.site],
            model.site_bodyid[self.site],
            applied,
        )
        return np.asarray(data.qfrc_passive - data.qfrc_bias + applied)

    def _constraints(self) -> tuple[Array, Array]:
        """Residual (m,) [m] and Jacobian (m, nv) of the equality constraints."""
        rows = self.data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
        jacobian = self.data.efc_J.reshape(-1, self.model.nv)[rows]
        return self.data.efc_pos[rows].copy(), jacobian.copy()

    def _residual(self, state: Array, wrench: Array) -> Array:
        nv = self.model.nv
        force = self._forward(state[:nv], wrench)
        residual, jacobian = self._constraints()
        return np.concatenate([force + jacobian.T @ state[nv:], residual])

    def rest(self, wrench: ArrayLike) -> Array:
        """(nq,) coordinates of the equilibrium under a wrench held constant in the world."""
        load, nv = np.asarray(wrench, float), self.model.nv
        self._forward(self.relaxed, load)
        state = np.concatenate([self.relaxed, np.zeros(len(self._constraints()[0]))])
        size = np.inf
        for _ in range(30):
            residual = self._residual(state, load)
            tangent = np.empty((len(residual), len(state)))
            for column in range(len(state)):
                # Multipliers enter linearly: any step is exact, a large one is accurate.
                step = 1e-5 if column < nv else 1.0
                change = np.zeros(len(state))
                change[column] = step
                ahead = self._residual(state + change, load)
                behind = self._residual(state - change, load)
                tangent[:, column] = (ahead - behind) / (2 * step)
            # A spatial pin in a planar loop has one redundant row: rows and columns are scaled
            # to one size, then least squares drops the null direction.
            rows = 1.0 / np.maximum(np.abs(tangent).max(axis=1), 1e-9)
            cols = 1.0 / np.maximum(np.abs(rows[:, None] * tangent).max(axis=0), 1e-9)
            scaled = rows[:, None] * tangent * cols
            update = cols * np.linalg.lstsq(scaled, -rows * residual, rcond=1e-10)[0]
            state = state + update
            previous, size = size, float(np.max(np.abs(update[:nv])))
            # Near poses where the loop falls into line, rounding keeps the last steps above zero.
            if size < 1e-14 or (size < 1e-10 and size > previous / 2):
                return np.asarray(state[:nv])
        raise RuntimeError(f"no equilibrium: last step {size:.1e} rad")

    def _pose(self, qpos: Array) -> tuple[Array, Array, float]:
        self._forward(qpos, np.zeros(6))
        residual, _ = self._constraints()
        turn = self.data.site_xmat[self.site].reshape(3, 3).copy()
        gap = float(np.max(np.abs(residual), initial=0.0))
        return self.data.site_xpos[self.site].copy(), turn, gap

    def deflection(self, wrench: ArrayLike, qpos: Array | None = None) -> Deflection:
        """Displacement and rotation of the tip at rest (or at given loaded coordinates)."""
        loaded = self.rest(wrench) if qpos is None else qpos
        before, turn_before, _ = self._pose(self.relaxed)
        after, turn_after, gap = self._pose(loaded)
        unloaded = np.eye(4)
        unloaded[:3, :3], unloaded[:3, 3] = turn_before, before
        return Deflection(
            displacement=after - before,
            rotation=rotation_vector(turn_after @ turn_before.T),
            position=after,
            unloaded=unloaded,
            qpos=loaded,
            closure=gap,
        )

    def settle(self, wrench: ArrayLike, start: Array | None = None, steps: int = 4000) -> Array:
        """(nq,) coordinates after stepping time under the wrench, from `start` or from relaxed."""
        load, model, data = np.asarray(wrench, float), self.model, self.data
        mujoco.mj_resetData(model, data)
        data.qpos[:] = self.relaxed if start is None else start
        for _ in range(steps):
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            data.qfrc_applied[:] = 0.0
            mujoco.mj_applyFT(
                model,
                data,
                load[:3],
                load[3:],
                data.site_xpos[self.site],
                model.site_bodyid[self.site],
                data.qfrc_applied,
            )
            mujoco.mj_step(model, data)
        return data.qpos.copy()
