"""How stiff the arm is at the poses that were measured."""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import two_digits
from sk120stiff.identify import Fit
from sk120stiff.model import LoadedStiffness, loaded_stiffness
from sk120stiff.show.figures import PlaneEllipse, plane_ellipses
from sk120stiff.show.report import Picture, Section, Table
from sk120stiff.show.stories.scenes import arm_views, largest_loads
from sk120stiff.show.wording import number


def stiffness_section(fit: Fit) -> Section:
    """Principal stiffness at every measured pose under its largest load, and the ellipses."""
    load_cases = fit.problem.load_cases
    found: dict[str, tuple[LoadedStiffness, Array]] = {}
    for label, row in largest_loads(load_cases).items():
        wrench = load_cases.wrench[row]
        found[label] = (loaded_stiffness(fit.model, load_cases.a[row], wrench), wrench)
    critical = min(stiff.critical_factor for stiff, _ in found.values())
    change = max(_share_of_K_C(stiff) for stiff, _ in found.values())
    return Section(
        "How stiff the arm is at these poses",
        [
            f"Under the largest load of each pose, K_C changes a principal stiffness by at most "
            f"{two_digits(100.0 * change)} %: it closes no gap here. "
            f"{number(critical, 3)} times the load would make the arm unstable.",
            _table(found),
            _ellipses(fit, {label: stiff for label, (stiff, _) in found.items()}),
        ],
    )


def _share_of_K_C(found: LoadedStiffness) -> float:
    with_it = np.linalg.eigvalsh(found.compliance_enhanced[:3, :3])
    without = np.linalg.eigvalsh(found.compliance_conventional[:3, :3])
    return float(np.max(np.abs(without / with_it - 1.0)))


def _table(found: dict[str, tuple[LoadedStiffness, Array]]) -> Table:
    rows = []
    for label, (stiff, wrench) in found.items():
        softest = stiff.principal.directions[0]
        direction = ", ".join(f"{component:+.2f}" for component in softest).replace("-", "−")
        rows.append((f"pose {label}", float(np.linalg.norm(wrench[:3])),
                     *(1e-6 * float(value) for value in stiff.principal.values),
                     1e6 / float(stiff.principal.values[0]), direction))  # fmt: skip
    return Table(
        ["", "load", "softest", "middle", "stiffest", "yields", "softest direction (x, y, z)"],
        rows,
        "Principal stiffness of the flange with the identified springs, K_C included, and how far "
        "it yields to a force along its softest direction.",
        ["", "N", "N/µm", "N/µm", "N/µm", "µm/N", ""],
        digits=3,
    )


def _ellipses(fit: Fit, found: dict[str, LoadedStiffness]) -> Picture:
    drawn = [
        PlaneEllipse(
            centre=view.outline[-1],
            compliance=found[view.label].compliance_enhanced[:3, :3],
            label=f"pose {view.label}",
            outline=view.outline,
        )
        for view in arm_views(fit, {})
    ]
    yields = "; ".join(
        f"pose {label} {two_digits(1e6 / stiff.principal.values[0])} µm/N"
        for label, stiff in found.items()
    )
    return Picture(
        lambda: plane_ellipses(drawn, plane="xy", name="yields to a force of 1 N"),
        alt=f"The arm from above at {len(drawn)} poses with its compliance ellipses; softest: "
        f"{yields}.",
        caption="From above: how far the flange yields to a force of one size in every horizontal "
        "direction. The long axis is the soft one.",
    )
