"""The folder of a campaign: its settings, its readings so far, and the reading to take next.

The folder is the state. `pilot.yaml` says what does not change, `readings.csv` grows, `next.csv`
holds what comes next; everything else follows from these.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import yaml
from pydantic import ConfigDict, Field

from sk120stiff import units
from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.files import (
    Strict,
    csv_text,
    read_text,
    read_yaml,
    running,
    validated,
    write_atomically,
)
from sk120stiff.measurements import Measurements, read_measurements, write_measurements
from sk120stiff.measurements.noise_statement import NoiseStatement
from sk120stiff.model import Model
from sk120stiff.pilot.campaign import Campaign
from sk120stiff.plan import Cell, feasible_pool
from sk120stiff.plan.planned import to_be_taken

LIKE = {  # what can be written, by key
    "point": "point: 0,50,120 mm", "force": "force: 400 N", "noise": "noise: 10 um",
    "zero": "zero: separate   (or shared)", "target": "target: 2 %", "most": "most: 60",
    "poses": "poses: 150", "directions": "directions: 6", "seed": "seed: 0",
}  # fmt: skip
SAME = 1e-6  # m by which two statements of a point may differ
SETTINGS, READINGS, NEXT = "pilot.yaml", "readings.csv", "next.csv"


class Settings(Strict):
    """The keys of `pilot.yaml`."""

    model_config = ConfigDict(coerce_numbers_to_str=True)

    model: str
    cell: str | None = None
    point: str = "0, 0, 0 mm"
    force: str = "400 N"
    noise: str = "10 um"
    zero: Literal["separate", "shared"] = "separate"
    target: str | None = None
    most: Annotated[int, Field(ge=1, le=1000)] = 60
    poses: Annotated[int, Field(ge=10, le=5000)] = 150
    directions: Annotated[int, Field(ge=1, le=100)] = 6
    seed: Annotated[int, Field(ge=0)] = 0

    def checked(self) -> Settings:
        """The same, once every text was read as the size that it states.

        Raises:
            InputError: A number without a unit, or with one of another kind; `where` is the key.
        """
        _ = self.sigma, self.share, self.at, self.newtons
        return self

    @property
    def newtons(self) -> float:
        """Largest load [N]."""
        return units.parse_size(self.force, "force", where="force", like="400 N")

    @property
    def sigma(self) -> float:
        """Standard uncertainty of one reading per axis [m]."""
        return units.parse_size(self.noise, "length", where="noise", like="10 um")

    @property
    def share(self) -> float | None:
        """Relative standard error of the springs that is enough."""
        if self.target is None:
            return None
        return units.parse_size(self.target, "dimensionless", where="target", like="2 %")

    @property
    def at(self) -> Array:
        """(3,) measured and loaded point, tool frame [m]."""
        return units.parse_values(self.point, "length", where="point", like="0,50,120 mm")

    def campaign(self, model: Model, cell: Cell) -> Campaign:
        """What they describe.

        Raises:
            InputError: A number without a unit, or none at all.
            Refusal: Next to no pose can be had.
        """
        pool = feasible_pool(
            model.robot,
            poses=self.poses,
            directions=self.directions,
            force=self.newtons,
            point=self.at,
            seed=self.seed,
            cell=cell,
        )
        return Campaign.of(model, pool, self.sigma, target=self.share, most=self.most)


@dataclass(frozen=True)
class Folder:
    """A campaign's folder."""

    path: Path

    @property
    def readings_file(self) -> Path:
        """The file that grows."""
        return self.path / READINGS

    def settings(self) -> Settings:
        """What `pilot.yaml` says.

        Raises:
            InputError: There is none, or it holds what it may not.
        """
        file = self.path / SETTINGS
        if not file.is_file():
            raise InputError(
                "no campaign was begun here", where=str(self.path),
                remedy=f"Begin one: sk120stiff pilot {self.path} --model model.yaml",
            )  # fmt: skip
        said = validated(Settings, read_yaml(file).content, str(file), LIKE)
        try:
            return said.checked()
        except InputError as error:
            place = f"{file}, key {error.where!r}"
            raise InputError(error.what, where=place, remedy=error.remedy) from error

    def refuse_another(self, settings: Settings) -> None:
        """Say no to a new campaign where there is one already.

        Raises:
            InputError: Another one is under way here.
        """
        file = self.path / SETTINGS
        if file.is_file() and self.settings() != settings:
            raise InputError(
                "a campaign with other settings is under way here", where=str(file),
                remedy="Leave the options out to go on with it, edit the file, or take another "
                "folder.",
            )  # fmt: skip
        if self.path.exists() and not self.path.is_dir():
            raise InputError(
                "this is a file, not a folder", where=str(self.path), remedy="Name a folder."
            )

    def begin(self, settings: Settings) -> None:
        """Write the settings of a new campaign."""
        self.path.mkdir(parents=True, exist_ok=True)
        said = settings.model_dump(exclude_none=True)
        file = self.path / SETTINGS
        write_atomically(file, str(yaml.safe_dump(said, sort_keys=False, allow_unicode=True)))

    def beside(self, named: str) -> Path:
        """A file that the settings name, seen from the folder."""
        return Path(os.path.normpath(self.path / named))

    def readings(self, settings: Settings) -> Measurements | None:
        """The readings so far; None before the first.

        Raises:
            InputError: The file cannot be read, or states other things than the settings do.
        """
        if not self.readings_file.is_file() or not self._rows():
            return None
        read = read_measurements(self.readings_file)
        apart = _differing(settings, read)
        if apart:
            raise InputError(
                f"{SETTINGS} and readings.yaml state different things: {'; '.join(apart)}",
                where=str(self.path),
                remedy="Correct the one that is wrong.",
            )
        return read

    def propose(self, campaign: Campaign, settings: Settings, row: int, label: str) -> Measurements:
        """Write the reading to take next, and on the first call an empty file for the readings."""
        plan = to_be_taken(campaign.model.robot, campaign.pool, [row], zero=settings.zero)
        file = self.path / NEXT
        plan = replace(
            plan, pose=(label,), noise=NoiseStatement(settings.sigma),
            source="the reading that 'sk120stiff pilot' proposes",
        )  # fmt: skip
        with running():  # the campaign's own files, again and again
            write_measurements(plan, file)
            if not self.readings_file.is_file():
                first = replace(plan, displacement=np.zeros((1, 3)), source="read for the pilot")
                write_measurements(first, self.readings_file)
                header = self.readings_file.read_text(encoding="utf-8").splitlines()[0]
                write_atomically(self.readings_file, header + "\n")
        return plan

    def append(self, taken: Measurements, displacement: Array) -> None:
        """Add one reading (3,) [m] to the file, under the headers that it has.

        Raises:
            InputError: A header without a unit, or a column that a reading needs is missing.
        """
        cells: dict[str, tuple[float, str]] = dict(
            zip(
                taken.joint_names,
                zip(taken.joints[0].tolist(), taken.joint_kinds, strict=True),
                strict=True,
            )
        )
        for k, axis in enumerate("xyz"):
            cells[f"f{axis}"] = (float(taken.wrench[0, k]), "force")
            cells[f"m{axis}"] = (float(taken.wrench[0, 3 + k]), "moment")
            cells[f"d{axis}"] = (float(displacement[k]), "length")
        text = read_text(self.readings_file)
        row = self._row(text.splitlines()[0], cells, taken.pose[0])
        end = "" if text.endswith("\n") else "\n"
        with running():  # what was read here is what grows
            write_atomically(self.readings_file, f"{text}{end}{row}\n")

    def _row(self, header: str, cells: Mapping[str, tuple[float, str]], label: str) -> str:
        where = str(self.readings_file)
        names = next(csv.reader([header]))
        out: list[tuple[str, list[object]]] = []
        known = set()
        for name in names:
            key, unit = units.split_header(name, where=where)
            known.add(key)
            cell: object = label if key == "pose" else ""
            if key in cells:
                value, kind = cells[key]
                cell = float(units.from_si(value, unit, kind, where=where))
            out.append((name, [cell]))
        lacking = [key for key in cells if key not in known and not key.startswith("m")]
        if lacking:
            raise InputError(f"the column {lacking[0]!r} is missing", where=where)
        return csv_text(out).splitlines()[1]

    def _rows(self) -> int:
        lines = read_text(self.readings_file).splitlines()
        return len([line for line in lines if line.strip() and not line.startswith("#")]) - 1


def _differing(settings: Settings, read: Measurements) -> list[str]:
    """What the settings and the readings' own file state differently, in words."""

    def mm(point: Array) -> str:
        return ",".join(f"{1e3 * x + 0.0:g}" for x in point) + " mm"

    said = []
    for key, point in (("point", read.point), ("point of the force", read.force_point)):
        if np.abs(point - settings.at).max() > SAME:
            said.append(f"{key} {mm(settings.at)} and {mm(point)}")
    if read.zero != settings.zero:
        said.append(f"zero {settings.zero} and {read.zero}")
    sigma = read.noise.sigma
    if sigma is not None and abs(sigma - settings.sigma) > 1e-3 * settings.sigma:
        said.append(f"noise {1e6 * settings.sigma:g} um and {1e6 * sigma:g} um")
    return said
