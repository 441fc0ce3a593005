"""A sealed case of positions: its files for the program, its truth for the scorer."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml

from .positions import Truth, Visits
from .rotations import Array

GEOMETRY = ("joint_frame", "joint_offset", "link_length")
SETTLED = {
    "transmission_error": ("sin_1", "cos_1", "sin_2", "cos_2"), "joint_coupling": ("ratio",),
    "approach_side": ("half_width",), "lost_motion": ("half_width",),
    "thermal_growth": ("growth",),
    "payload": ("mass", "moment_x", "moment_y", "moment_z"), "marker_shift": ("1.x", "1.y", "1.z"),
}  # fmt: skip


@dataclass(frozen=True)
class Seen:
    """A hidden cause: its size, what it does, what is left beside all others, what comes near."""

    name: str
    where: str
    size: Array
    visibility: float
    left: float
    asked: bool  # plain enough that an answer must name it
    rivals: list[tuple[float, str, str]]


@dataclass(frozen=True)
class PositionCase:
    """Data of one case and its truth."""

    level: str
    seed: tuple[int, ...]
    truth_: Truth
    train: Visits
    holdout: Visits
    sealed: Visits
    sigma: float
    stated: bool
    hidden: list[Seen]
    rough: Array
    urdf: str

    def check(self) -> None:
        """Every set has to have an equilibrium."""
        for visits in (self.train, self.holdout, self.sealed):
            self.truth_.positions(visits)

    def truth(self) -> dict[str, object]:
        """The sealed JSON document."""
        arm, told = self.truth_.arm, {seen.name for seen in self.hidden}
        return {
            "level": self.level, "robot": arm.name, "seed": list(self.seed), "expected": "named",
            "note": ("" if self.stated else "sigma not stated ")
            + ("yields" if self.truth_.compliance else "rigid"),
            "accepted": [f"{name}:{joint.name}" for name in GEOMETRY for joint in arm.joints],
            "effects": [_entry(seen) for seen in self.hidden],
            "springs": {name: 1.0 / c for name, c in self.truth_.compliance.items()},
            "elastic": bool(self.truth_.compliance) or "link_bending" in told,
            "oracle": np.round(self.truth_.positions(self.sealed), 10).tolist(),
            "sealed_sigma_um": 1e6 * self.sigma,
        }  # fmt: skip

    def write(self, name: str, cases: Path, truth: Path) -> None:
        """`cases/name/` for the program, `truth/name.json` and `sealed/name/` beside them."""
        folder, sealed = cases / name, truth.parent / "sealed" / name
        rng = np.random.default_rng((*self.seed, 777))
        for place in (folder, sealed, truth):
            place.mkdir(parents=True, exist_ok=True)
        for place, stem, visits in (
            (folder, "train", self.train), (folder, "holdout", self.holdout),
            (sealed, "sealed", self.sealed),
        ):  # fmt: skip
            (place / self.truth_.arm.reference).write_text(self.urdf, encoding="utf-8")
            (place / f"{stem}.csv").write_text(self._table(visits, rng), encoding="utf-8")
            text = yaml.safe_dump(self._description(visits), sort_keys=False)
            (place / f"{stem}.yaml").write_text(text, encoding="utf-8")
        (folder / "command.json").write_text("[]", encoding="utf-8")
        document = json.dumps(self.truth(), indent=1)
        (truth / f"{name}.json").write_text(document, encoding="utf-8")

    def _description(self, visits: Visits) -> dict[str, object]:
        arm = self.truth_.arm
        out: dict[str, object] = {
            "robot": arm.reference, "base_frame": arm.base_frame, "tool_frame": arm.tool_frame,
            "position": {"frame": "unknown"},
            "point": {"xyz": [round(1e3 * float(v), 3) for v in self.rough], "unit": "mm",
                      "fit": True},
            "gravity": [0.0, 0.0, -9.81],
        }  # fmt: skip
        if visits.payload.any():
            hung = [round(1e3 * float(v), 6) for v in visits.hung]
            out["payload"] = {"point": {"xyz": hung, "unit": "mm"}, "fit": False}
        if self.stated:
            out["noise"] = {"sigma": round(1e6 * self.sigma, 3), "unit": "um"}
        return out

    def _table(self, visits: Visits, rng: np.random.Generator) -> str:
        x = self.truth_.positions(visits) + self.sigma * rng.normal(size=(visits.count, 3))
        names = list(visits.values)
        more = {
            "payload[kg]": (visits.payload, visits.payload.any()),
            "temperature[degC]": (20.0 + visits.temperature, np.ptp(visits.temperature) > 0.0),
            "series": (visits.series, visits.series.any()),
        }
        used = {key: values for key, (values, there) in more.items() if there}
        header = ["pose", *(f"{n}[deg]" for n in names), "x[mm]", "y[mm]", "z[mm]", *used, "order"]
        lines = [",".join(header)]
        for k in range(visits.count):
            cells = [f"P{visits.pose[k]}"]
            cells += [f"{np.degrees(visits.values[n][k]):.9f}" for n in names]
            cells += [f"{1e3 * v:.7f}" for v in x[k]]
            cells += [f"{values[k]:.6g}" for values in used.values()] + [str(k)]
            lines.append(",".join(cells))
        return "\n".join(lines) + "\n"


def _entry(seen: Seen) -> dict[str, object]:
    names = SETTLED.get(seen.name, ())
    return {
        "name": seen.name, "where": seen.where,
        "sizes": [float(v) for v in seen.size],
        "quantities": dict(zip(names, map(float, seen.size), strict=bool(names))),
        "visibility": round(seen.visibility, 2), "left": round(seen.left, 2), "asked": seen.asked,
        "rivals": [
            {"name": name, "where": where, "separation": round(float(apart), 2)}
            for apart, name, where in seen.rivals
        ],
    }  # fmt: skip
