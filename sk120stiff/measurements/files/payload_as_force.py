"""Displacements under payloads: readings need forces, and one command makes them of masses."""

from __future__ import annotations

import shlex

from sk120stiff.errors import InputError
from sk120stiff.measurements.table.columns import DISPLACEMENTS, FORCES, MOMENTS
from sk120stiff.measurements.table.settings import PointEntry, Settings
from sk120stiff.measurements.table.table import Table


def refuse_payload_for_force(table: Table, settings: Settings, robot: str | None) -> None:
    """Refuse a payload in the place of a force, with the command that turns one into the other.

    Args:
        table: The readings.
        settings: What the YAML file beside them states.
        robot: The robot that it names, as it is found from anywhere.

    Raises:
        InputError: Displacements have a column payload, and no force.
    """
    names = table.headers.keys()
    forced = names & {*FORCES, *MOMENTS}
    if "payload" not in names or not names & set(DISPLACEMENTS) or forced:
        return
    out = table.path.with_name(f"{table.path.stem}_forces.csv")
    at, hung = settings.point, None if settings.payload is None else settings.payload.point
    point = "X,Y,Z mm" if at is None else f"{_listed(at)} {at.unit}"
    place = [] if hung is None else ["--payload-point", f"{_listed(hung)} {hung.unit}"]
    frames = {"--base": settings.base_frame, "--tool": settings.tool_frame}
    words = [
        "sk120stiff", "import", str(table.path), "--robot", robot or "ROBOT",
        *(word for option, name in frames.items() if name for word in (option, name)),
        "--point", point, *place, "--out", str(out),
    ]  # fmt: skip
    raise InputError(
        "the column 'fx' is missing: displacements go with forces, and these with a payload",
        where=f"{table.path}, line {table.header_line}",
        remedy=f"Make forces of it: {shlex.join(words)} . They pull along -z of the base "
        "where the payload hangs: at --payload-point, the centre of its mass in the tool frame, by "
        f"default the origin of that. Take over into {out.stem}.yaml what else the YAML file "
        "states (noise, displacement). Or add fx[N], fy[N], fz[N] by hand.",
    )


def _listed(point: PointEntry) -> str:
    return ", ".join(f"{v:g}" for v in point.xyz)
