"""Closed loops of any kind: joints that follow others because two frames must coincide.

The dependent joints d solve C(q) = 0 for given coordinates a, with q = A [a; d] + b (mimic rules
inside a loop are part of A). With C_d and C_a the derivatives of C::

    ∂d/∂a = −C_d⁺ C_a            ∂²d/∂a_i ∂a_j = −C_d⁺ Σ_kl C''_kl G_ki G_lj,   G = dq/da

which is exact wherever C can be solved, redundant rows included (a planar loop has them).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.errors import Refusal
from sk120stiff.robot.kinematics.chain import VirtualJoint
from sk120stiff.robot.kinematics.coupling import Curvature, JointMotion, LinearCoupling
from sk120stiff.robot.loops.closing import Closer
from sk120stiff.robot.loops.constraint import Closure, Gap

CLOSED = 1e-9  # parts of a loop's length: a larger gap is open
NEARLY = 1e-4  # parts of a loop's length: a gap that Newton closes no further at a dead point
DEAD = 1e-6  # parts of a loop's length: a smaller singular value of C_d leaves joints undetermined
NEAR = 0.1  # rad, or parts of a loop's length: poses this close need no walk from the start


class OpenLoop(Refusal):
    """A loop cannot be closed at some poses.

    Attributes:
        rows: (k,) which of the poses, counted over the flattened batch.
    """

    def __init__(self, what: str, *, where: str, remedy: str, rows: Index) -> None:
        super().__init__(what, where=where, remedy=remedy)
        self.rows = rows


@dataclass(frozen=True, eq=False)
class LoopCoupling:
    """Coupling of a robot with closed loops.

    Attributes:
        closer: The loops as equations for the dependent joints.
        names: Names of the n coordinates a, and of the r dependent joints.
        turns: (n + r,) whether each of them is an angle.
        start: (n + r,) values at which every loop is closed, in the wanted assembly mode.
        elastic: Number of virtual joints among the n coordinates, which come last.
    """

    closer: Closer
    names: tuple[str, ...]
    turns: Mask
    start: Array
    elastic: int = 0
    _last: dict[str, tuple[Array, Array]] = field(default_factory=dict)

    @property
    def n(self) -> int:
        """Number of coordinates."""
        return self.closer.driven

    @property
    def m(self) -> int:
        """Number of moving joints."""
        return self.closer.linear.m

    @property
    def dependent(self) -> tuple[str, ...]:
        """Names of the joints that the loops determine."""
        return self.names[self.n :]

    @property
    def closures(self) -> tuple[Closure, ...]:
        """What is closed."""
        return tuple(constraint.closure for constraint in self.closer.constraints)

    def motion(self, a: Array) -> JointMotion:
        """Joint values and derivatives at `a` (..., n).

        Raises:
            OpenLoop: A loop cannot be closed at a pose, or stands at a dead point; loop and pose
                are named.
        """
        batch = a.shape[:-1]
        z = a.reshape(-1, self.n)
        d, closed = self._closed(z)
        if not closed.all():
            raise self._open(z, np.flatnonzero(~closed))
        gaps = self.closer.gaps(z, d)
        self._check(z, gaps)
        G_d, curvature = self._derivatives(gaps)
        A = self.closer.linear.A
        first = A[:, : self.n] + A[:, self.n :] @ G_d  # (N, m, n)
        q = self.closer.linear.motion(np.concatenate([z, d], axis=1)).q
        r, s = curvature.hessian.shape[1:3]
        return JointMotion(
            q=q.reshape(*batch, self.m),
            first=first.reshape(*batch, self.m, self.n),
            second=Curvature(
                curvature.joints,
                curvature.coordinates,
                curvature.hessian.reshape(*batch, r, s, s),
            ),
        )

    def closes(self, a: Array, margin: float = DEAD) -> Mask:
        """(...,) whether every loop can be closed at `a` (..., n), away from dead points.

        `margin` is the least singular value of the loops' equations over their length. It falls
        to zero at a dead point, in proportion to the sine of a four-bar's transmission angle.
        """
        z = a.reshape(-1, self.n)
        d, closed = self._closed(z)
        held = np.flatnonzero(closed)
        if len(held):
            closed[held] = self._spread(self.closer.gaps(z[held], d[held])) > margin
        return np.asarray(closed.reshape(a.shape[:-1]))

    def with_virtual_joints(
        self, virtual: Sequence[VirtualJoint], bodies: Sequence[str]
    ) -> LoopCoupling:
        """The coupling of coordinates [a; v] to joint values [q; v].

        A virtual joint that sits on a link of a loop moves what lies beyond it, and the dependent
        joints give way. On the body that carries a closing frame itself it is taken to lie beyond
        that frame.

        Args:
            virtual: Virtual joints of the arm's chain.
            bodies: Names of the chain's joints, which `VirtualJoint.body` counts.
        """
        old, extra = self.closer, len(virtual)
        n, m = self.n, self.m
        A = np.zeros((m + extra, n + extra + len(self.dependent)))
        A[:m, :n] = old.linear.A[:, :n]
        A[:m, n + extra :] = old.linear.A[:, n:]
        A[m:, n : n + extra] = np.eye(extra)
        constraints = tuple(c.with_virtual_joints(virtual, bodies, m) for c in old.constraints)
        felt = {int(k) for c in constraints for k in c.coordinates}
        weight = [
            (1.0 if joint.revolute else old.size) if m + k in felt else np.inf
            for k, joint in enumerate(virtual)
        ]
        closer = Closer(
            linear=LinearCoupling(A, np.append(old.linear.b, np.zeros(extra))),
            driven=n + extra,
            scale=np.concatenate([old.scale[:n], weight, old.scale[n:]]),
            constraints=constraints,
            rows=old.rows,
        )
        return LoopCoupling(
            closer=closer,
            names=(*self.names[:n], *(joint.name for joint in virtual), *self.dependent),
            turns=np.concatenate([self.turns[:n], [j.revolute for j in virtual], self.turns[n:]]),
            start=np.concatenate([self.start[:n], np.zeros(extra), self.start[n:]]),
            elastic=extra,
        )

    def _closed(self, z: Array) -> tuple[Array, Mask]:
        """Dependent joints (N, r) at z (N, n), and where they were found."""
        count = len(z)
        known = self._last.get("poses")
        if known is not None and len(known[0]) == count:
            scale = self.closer.scale
            away = np.abs((z - known[0]) / scale[: self.n]).max(initial=0.0)
            if away < NEAR:
                d, closed = self.closer.newton(z, known[1])
                moved = np.abs((d - known[1]) / scale[self.n :]).max(initial=0.0)
                if closed.all() and moved < 3.0 * NEAR:
                    self._last["poses"] = (z.copy(), d)
                    return d, closed
        # equal poses are walked to once
        felt = np.isfinite(self.closer.scale[: self.n])
        _, pick, back = np.unique(z[:, felt], axis=0, return_index=True, return_inverse=True)
        some, arrived = self._walked(z[pick])
        d, closed = some[back.reshape(-1)], arrived[back.reshape(-1)]
        if closed.all():
            self._last["poses"] = (z.copy(), d)
        return d, closed

    def _walked(self, z: Array) -> tuple[Array, Mask]:
        """Walk from the start: straight, else one coordinate after the other."""
        count = len(z)
        start = np.tile(self.start, (count, 1))
        d, arrived, _, _ = self.closer.follow(start[:, : self.n], start[:, self.n :], z)
        felt = np.flatnonzero(np.isfinite(self.closer.scale[: self.n]))
        for order in (felt, felt[::-1]) if len(felt) > 1 else ():
            todo = np.flatnonzero(~arrived)
            if not len(todo):
                break
            way, own = start[todo, : self.n], start[todo, self.n :]
            ok = np.ones(len(todo), dtype=bool)
            for k in order:
                goal = way.copy()
                goal[:, k] = z[todo, k]
                own, here, _, _ = self.closer.follow(way, own, goal)
                ok &= here
                way = goal
            own, closed = self.closer.newton(z[todo], own)
            d[todo[ok]], arrived[todo[ok]] = own[ok], closed[ok]
        return d, arrived

    def _derivatives(self, gaps: list[Gap]) -> tuple[Array, Curvature]:
        """(N, r, n) ∂d/∂z, and the second derivative of all joints that depend on d."""
        closer, n = self.closer, self.n
        _, derivative = closer.system(gaps)
        reduced = closer.reduced(derivative)
        C_d = reduced[:, :, n:]
        G_d = -closer.solve(C_d, reduced[:, :, :n])
        felt = self._felt
        bent = []
        for gap, A in zip(gaps, closer.maps(), strict=True):
            motion = A[:, felt] + A[:, n:] @ G_d[:, :, felt]  # (N, k, s)
            bent.append(gap.second(motion))
        sources = closer.reduced(np.concatenate(bent, axis=1))  # (N, r, s, s)
        count, rows, s, _ = sources.shape
        H_d = -closer.solve(C_d, sources.reshape(count, rows, s * s))
        followers, _ = self.bending
        hessian = closer.linear.A[followers, n:] @ H_d
        return G_d, Curvature(followers, felt, hessian.reshape(count, len(followers), s, s))

    @property
    def pattern(self) -> Mask:
        """See `Coupling`."""
        joints, coordinates = self.bending
        found = self.closer.linear.A[:, : self.n] != 0.0
        found[joints[:, None], coordinates] = True
        return np.asarray(found)

    @cached_property
    def bending(self) -> tuple[Index, Index]:
        """See `Coupling`."""
        return np.flatnonzero(self.closer.linear.A[:, self.n :].any(axis=1)), self._felt

    @cached_property
    def _felt(self) -> Index:
        """Coordinates that any loop feels."""
        return np.flatnonzero(np.isfinite(self.closer.scale[: self.n]))

    def _spread(self, gaps: list[Gap]) -> Array:
        """(N,) smallest singular value of C_d over the loop's length."""
        _, derivative = self.closer.system(gaps)
        C_d = self.closer.reduced(derivative)[:, :, self.n :] * self.closer.scale[self.n :]
        values = np.linalg.svd(C_d / self.closer.size, compute_uv=False)
        return np.asarray(values[:, -1])

    def _check(self, z: Array, gaps: list[Gap]) -> None:
        dead = np.flatnonzero(self._spread(gaps) <= DEAD)
        if len(dead):
            raise OpenLoop(
                f"{self._loops} stands at a dead point, where its joints are not determined"
                f"{_of(len(dead), len(z))}",
                where=self._pose(z[dead[0]]),
                remedy="Move the driven joints away from this pose.",
                rows=dead,
            )
        if self.elastic:  # a planar loop has play across its plane: a twisted link does not open it
            return
        for gap, constraint in zip(gaps, self.closer.constraints, strict=True):
            apart = np.linalg.norm(gap.value, axis=1)
            rows = np.flatnonzero(apart > CLOSED * constraint.size)
            if len(rows):
                raise OpenLoop(
                    f"the loop {constraint.closure.name!r} stays open by "
                    f"{1e3 * apart[rows[0]]:.3g} mm{_of(len(rows), len(z))}: its dependent joints "
                    "cannot bring the two frames together in all directions",
                    where=self._pose(z[rows[0]]),
                    remedy="Use type: point for a planar linkage, or name more dependent joints.",
                    rows=rows,
                )

    def _open(self, z: Array, rows: Index) -> OpenLoop:
        """Why a pose cannot be reached: it cannot be closed at all, or only beyond a dead point."""
        bad = z[rows[0]]
        rng = np.random.default_rng(0)
        scale = self.closer.scale[self.n :]
        guesses = self.start[self.n :] + scale * rng.uniform(-np.pi, np.pi, (60, len(scale)))
        tried = np.tile(bad, (60, 1))
        found, closed = self.closer.newton(tried, guesses)
        gaps = self.closer.gaps(tried, found)
        sizes = [constraint.size for constraint in self.closer.constraints]
        apart = np.max(
            [np.linalg.norm(g.value, axis=1) / s for g, s in zip(gaps, sizes, strict=True)], axis=0
        )
        almost = apart.min() < NEARLY and not closed.any()
        if almost:  # Newton converges slowly to a double root
            what = f"{self._loops} stands at a dead point, where its joints are not determined"
            remedy = "Move the driven joints away from this pose."
        elif closed.any():
            what = f"{self._loops} reaches this pose only through a dead point"
            remedy = (
                "Where the robot does work there, write values of its joints at such a pose as "
                "start: under the closure in robot.yaml."
            )
        else:
            what = f"{self._loops} cannot be closed at this pose: a link would have to be longer"
            remedy = "Check the pose, its units, and the joint limits."
        return OpenLoop(
            what + _of(len(rows), len(z)), where=self._pose(bad), remedy=remedy, rows=rows
        )

    @property
    def _loops(self) -> str:
        names = ", ".join(repr(closure.name) for closure in self.closures)
        return f"the loop {names}" if len(self.closures) == 1 else f"one of the loops {names}"

    def _pose(self, z: Array) -> str:
        """The coordinates that the loops feel, as text."""
        own = [k for k in self._felt if k < self.n - self.elastic]
        words = [
            f"{self.names[k]} = {np.degrees(z[k]):.6g} deg"
            if self.turns[k]
            else f"{self.names[k]} = {1e3 * z[k]:.6g} mm"
            for k in own
        ]
        return "pose " + ", ".join(words)


def _of(some: int, total: int) -> str:
    return "" if total == 1 else f" (and so in {some} of {total} poses)"
