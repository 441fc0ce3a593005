"""The bundled UR5e against the maker's table, multiplied out by hand."""

import numpy as np
import pytest

import sk120stiff as sk

# a [m], d [m], alpha [rad], mass [kg], centre of mass in the frame behind the link [m]
TABLE = (
    (0.0, 0.1625, np.pi / 2, 3.761, (0.0, -0.02561, 0.00193)),
    (-0.425, 0.0, 0.0, 8.058, (0.2125, 0.0, 0.11336)),
    (-0.3922, 0.0, 0.0, 2.846, (0.15, 0.0, 0.0265)),
    (0.0, 0.1333, np.pi / 2, 1.37, (0.0, -0.0018, 0.01634)),
    (0.0, 0.0997, -np.pi / 2, 1.3, (0.0, 0.0018, 0.01634)),
    (0.0, 0.0996, 0.0, 0.365, (0.0, 0.0, -0.001159)),
)
POSES = np.random.default_rng(5).uniform(-np.pi, np.pi, (40, 6))


def frames(q: np.ndarray) -> list[np.ndarray]:
    """Denavit and Hartenberg: Rz(q) Tz(d) Tx(a) Rx(alpha), one frame behind every joint."""
    T, found = np.eye(4), []
    for angle, (a, d, alpha, _, _) in zip(q, TABLE, strict=True):
        c, s, ca, sa = np.cos(angle), np.sin(angle), np.cos(alpha), np.sin(alpha)
        step = [
            [c, -s * ca, s * sa, a * c],
            [s, c * ca, -c * sa, a * s],
            [0, sa, ca, d],
            [0, 0, 0, 1],
        ]
        T = T @ np.array(step)
        found.append(T)
    return found


@pytest.fixture(scope="module")
def robot():
    return sk.load_robot("ur5e")


def test_the_flange_is_where_the_makers_table_has_it(robot) -> None:
    ours = robot.placement(POSES, "tool0")
    theirs = np.array([frames(q)[-1] for q in POSES])
    assert np.abs(ours - theirs).max() < 1e-12


def test_the_weight_is_that_of_the_table(robot) -> None:
    """Torques of gravity: minus the slope of the potential energy of the table's masses."""

    def energy(q: np.ndarray) -> float:
        heights = [(T @ [*row[4], 1.0])[2] for T, row in zip(frames(q), TABLE, strict=True)]
        return 9.81 * sum(row[3] * z for row, z in zip(TABLE, heights, strict=True))

    step = 1e-5
    for q in POSES[:8]:
        slope = [
            (energy(q + step * e) - energy(q - step * e)) / (2 * step) for e in np.eye(6)
        ]  # fmt: skip
        held = robot.tree.gravity_torques(q, np.array([0.0, 0.0, -9.81]))
        np.testing.assert_allclose(held, np.negative(slope), atol=1e-7)


def test_its_springs_are_told_to_be_assumed(robot) -> None:
    from sk120stiff.model import typical_parameters
    from sk120stiff.model.typical import typical_stiffness

    model = sk.base_model(robot)
    assert len(typical_parameters(model)) == 6
    values = [p.value for p in model.parameters]
    np.testing.assert_allclose(values, typical_stiffness(robot), rtol=1e-9)


def test_five_kilograms_at_arms_length(robot) -> None:
    """Stretched out, the drop is Σ (lever² / K) F to first order; no beam and no wrist about z."""
    model = sk.base_model(robot)
    pose = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    found = sk.stiffness(model, pose, [0.0, 0.0, -5 * 9.81])
    chain = frames(np.zeros(6))
    tip, before = chain[-1][:3, 3], [np.eye(4), *chain[:-1]]
    drop = sum(
        np.cross(T[:3, 2], tip - T[:3, 3])[2] ** 2 / p.value
        for T, p in zip(before, model.parameters, strict=True)
    )
    assert found.deflection_conventional[2] == pytest.approx(-5 * 9.81 * drop, rel=2e-3)
