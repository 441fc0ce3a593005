"""Random robots as URDF text: any tree, every joint type, mimic rules that make sense."""

import numpy as np

KINDS = ("revolute", "continuous", "prismatic", "fixed")


def numbers(values: np.ndarray) -> str:
    return " ".join(repr(float(value)) for value in values)


def random_tree(seed: int, joints: int | None = None) -> str:
    """URDF text of a random tree.

    Joints come in random order, so followers may stand before their drivers and on other branches;
    mimic rules may be chained, mix joint types and have multiplier zero.
    """
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 13)) if joints is None else joints
    kinds = [str(rng.choice(KINDS, p=(0.45, 0.2, 0.15, 0.2))) for _ in range(count)]
    kinds[0] = "revolute"
    moving = [k for k, kind in enumerate(kinds) if kind != "fixed"]
    rank = {k: place for place, k in enumerate(rng.permutation(moving))}
    lines = []
    for k, kind in enumerate(kinds):
        # mostly a chain, so that arms are long, with some branches
        parent = k if rng.random() < 0.75 else int(rng.integers(0, k + 1))
        text = (
            f'<joint name="j{k}" type="{kind}"><parent link="l{parent}"/><child link="l{k + 1}"/>'
            f'<origin xyz="{numbers(rng.normal(size=3) * 0.4)}" '
            f'rpy="{numbers(rng.uniform(-3.1, 3.1, 3))}"/>'
        )
        if kind != "fixed":
            text += (
                f'<axis xyz="{numbers(unit(rng))}"/>'
                '<limit lower="-2" upper="2" effort="10" velocity="1"/>'
            )
            drivers = [d for d in moving if rank[d] < rank[k]]
            if k != 0 and drivers and rng.random() < 0.35:
                multiplier = float(rng.choice([0.0, 1.0, -1.0, rng.normal()]))
                text += (
                    f'<mimic joint="j{rng.choice(drivers)}" multiplier="{multiplier!r}" '
                    f'offset="{float(rng.normal()) * 0.3!r}"/>'
                )
        lines.append(text + "</joint>")
    for k in range(count + 1):
        inertial = (
            f'<inertial><origin xyz="{numbers(rng.normal(size=3) * 0.1)}"/>'
            f'<mass value="{float(rng.uniform(0, 20))!r}"/><inertia ixx="1" ixy="0" ixz="0" '
            'iyy="1" iyz="0" izz="1"/></inertial>'
        )
        lines.append(f'<link name="l{k}">{inertial if rng.random() < 0.8 else ""}</link>')
    return '<robot name="random">\n' + "\n".join(rng.permutation(lines)) + "\n</robot>\n"


def unit(rng: np.random.Generator) -> np.ndarray:
    """A skew unit axis, or one of the usual ones."""
    if rng.random() < 0.5:
        return np.eye(3)[rng.integers(3)] * rng.choice([-1.0, 1.0])
    axis = rng.normal(size=3)
    return np.asarray(axis / np.linalg.norm(axis))
