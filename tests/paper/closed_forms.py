"""K_C of the flange by hand: second derivatives of reach and height, nothing of the product.

In-plane reach r(t2, t3) and height z(t2, t3) are sums of a function of t2 and one of t3, so their
mixed derivative vanishes. Lengths in metres, forces in newtons.
"""

import numpy as np

L1, L2, L3, AHEAD = 0.215, 1.1, 0.25, 1.53
SPRINGS = np.array([1.4098e6, 4.0076e5, 9.3528e5])


def K_C(angles, force):
    """(N, 3, 3) for (N, 3) angles and one force."""
    t1, t2, t3 = angles.T
    out = np.array([np.cos(t1), np.sin(t1)])
    side = np.array([-np.sin(t1), np.cos(t1)])
    along, across = force[0] * out[0] + force[1] * out[1], force[0] * side[0] + force[1] * side[1]
    r = L1 + L2 * np.sin(t2) + AHEAD * np.cos(t3) - L3 * np.sin(t3)
    dr2, dr3 = L2 * np.cos(t2), -AHEAD * np.sin(t3) - L3 * np.cos(t3)
    ddr2, ddr3 = -L2 * np.sin(t2), -AHEAD * np.cos(t3) + L3 * np.sin(t3)
    ddz2, ddz3 = -L2 * np.cos(t2), -AHEAD * np.sin(t3) - L3 * np.cos(t3)
    K = np.zeros((len(angles), 3, 3))
    K[:, 0, 0] = -r * along
    K[:, 0, 1] = K[:, 1, 0] = dr2 * across
    K[:, 0, 2] = K[:, 2, 0] = dr3 * across
    K[:, 1, 1] = ddr2 * along + ddz2 * force[2]
    K[:, 2, 2] = ddr3 * along + ddz3 * force[2]
    return K


def grid():
    """The grid of section VI."""
    axes = [
        np.radians(low) + 0.2 * np.arange(count)
        for low, count in ((-180, 32), (-70, 13), (-115, 14))
    ]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
