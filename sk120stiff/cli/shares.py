"""Error budgets as tables: what yields, by how much it moves the point, and ±."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sk120stiff.cli.tables import table
from sk120stiff.explain import Explanation
from sk120stiff.model import Share

LISTED = 8  # shares that are printed; the JSON document has all


def budget_tables(answer: Explanation) -> list[object]:
    """At the measured loads, effect by effect and joint by joint; then the same of a task."""
    unit, task = "µm rms per axis", answer.task
    shown = budget_tables_of("At the measured loads", unit, answer.budget, answer.joints_budget)
    if task is not None:
        where = f"On the task {task.path} ({task.points} points)"
        shown += budget_tables_of(where, unit, task.effects, task.joints)
    return shown


def budget_tables_of(
    where: str,
    unit: str,
    effects: Sequence[Share],
    joints: Sequence[Share],
    size: float = 1.0,
    cause: str = "what yields",
) -> list[object]:
    """The largest shares, and how many there are; joints where more than a spring yields at one.

    Args:
        where, unit: Of the title.
        effects, joints: The shares.
        size: Times the rms per axis, what is printed.
        cause: What the effects are.
    """
    seen = [share for share in effects if share.rms > 0.0]
    if not seen:
        return []
    most = f", the largest {LISTED} of {len(seen)}" if len(seen) > LISTED else ""
    rows = [(share.name, *_sized(share, size)) for share in seen[:LISTED]]
    shown: list[object] = [table(f"{where}{most} [{unit}]", [cause, "moves", "±"], rows)]
    if any(len(share.members) > 1 for share in joints):
        rows = [(with_members(share), *_sized(share, size)) for share in joints if share.rms > 0.0]
        title = f"{where}, joint by joint [{unit}]"
        shown.append(table(title, ["all that yields at", "moves", "±"], rows))
    return shown


def with_members(share: Share) -> str:
    """A joint with what its sum is of, where that is more than its spring."""
    if len(share.members) < 2:
        return share.name
    return f"{share.name}: {' + '.join(name.partition(':')[0] for name in share.members)}"


def _sized(share: Share, size: float) -> tuple[object, object]:
    known = share.std is not None and np.isfinite(share.std)
    return 1e6 * size * share.rms, 1e6 * size * float(share.std or 0.0) if known else "?"
