"""`verdict.json`: one form of the answer, whatever was read; what does not apply is null or empty.

docs/FILES.md says what every key means.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from sk120stiff.errors import InputError
from sk120stiff.files.json_text import SCHEMA
from sk120stiff.files.schema import validated

VERDICT, BEST_GUESS, NEXT_POSES = "verdict.json", "best_guess.yaml", "next_poses.csv"
Outcome = Literal["none", "named", "ambiguous", "outside"]
Kind = Literal["named", "instead", "further", "none", "something_else", "marginal"]
Number = float | None  # null: it does not exist, is infinite or is not known
Evidence = dict[str, bool | int | float | str | None]


class Entry(BaseModel):
    """Keys of the document; those of later versions are left aside, as docs/STABILITY.md says."""

    model_config = ConfigDict(extra="ignore", frozen=True)


class ParameterEntry(Entry):
    """A parameter of the final model in public units."""

    name: str
    value: Number
    std: Number
    interval_95: tuple[Number, Number] | None
    unit: str
    meaning: str
    internal_value: Number
    internal_std: Number
    internal_unit: str
    reason: str | None
    before: Number = None
    plausible: bool | None = None


class SizeEntry(Entry):
    """What the parameters of a gear's law amount to together."""

    name: str
    value: float
    std: Number
    unit: str
    sentence: str


class EffectEntry(Entry):
    """A named effect."""

    name: str
    where: str
    alternatives: list[str]
    exact_aliases: list[str]
    probability: float
    share_um: Number
    parameters: list[ParameterEntry]
    size: SizeEntry | None = None
    sentence: str
    equation: str
    axes: str
    evidence: Evidence


class StepEntry(Entry):
    """The gap with one effect more in the model."""

    model: str
    fit_rms: Number
    heldout_rms: Number
    heldout_mean_distance: Number = None


class BorneOutEntry(Entry):
    """What readings of a hold-out file show of what was named."""

    file: str
    rms_um: Number
    without_um: Number
    share: float
    std: Number
    poses: int
    contradicted: bool


class GapEntry(Entry):
    """The gap, step by step."""

    unit: Literal["um", "urad"]
    noise_floor: Number
    p: Number
    rms_of_all: Number = None
    set_aside: int = 0
    steps: list[StepEntry]
    borne_out: BorneOutEntry | None


class GoesWithEntry(Entry):
    """What the remainder goes with."""

    name: str
    left_um: Number
    foretold_um: Number
    foretold_without_um: Number


class RemainderEntry(Entry):
    """What is left beyond the noise."""

    rms_um: Number
    interval_95: tuple[Number, Number]
    p: Number
    significant: bool
    proportional: Number = None
    constant_um: Number = None
    where: list[str]
    goes_with: GoesWithEntry | None = None


class OddsEntry(Entry):
    """One probability, and of what it is one."""

    name: str
    probability: float
    kind: Kind
    place: str | None


class ShareEntry(Entry):
    """What one effect, or all at one joint, moves the point by."""

    name: str
    members: list[str] = Field(default_factory=list)
    rms_um: Number
    std_um: Number


class TaskEntry(Entry):
    """The budget of a task."""

    path: str
    points: int
    effects: list[ShareEntry]
    joints: list[ShareEntry]


class SuspectEntry(Entry):
    """What came nearest where nothing is confirmed."""

    name: str
    heldout_gain_um: Number


class RowEntry(Entry):
    """A reading that was set aside, by pose and line of the file."""

    pose: str
    line: int
    slip: str | None = None


class NoiseEntry(Entry):
    """The noise that the answer was judged by."""

    model: str
    source: str
    sigma_um: Number
    degrees_of_freedom: Number = None
    growth: Number = None
    force: Number = None
    decided: list[str] = Field(default_factory=list)
    set_aside: list[RowEntry]


class AdequacyEntry(Entry):
    """Is anything left over?"""

    probability: Number
    left_over: Number
    explained: Number
    tests: dict[str, Number]
    understated: Number


class DetectableEntry(Entry):
    """The smallest size of a parameter that would have been named."""

    name: str
    value: Number
    unit: str


class PairEntry(Entry):
    """Two names that the proposed readings tell apart."""

    name: str
    rival: str
    apart: float
    settled: bool


class FamilyEntry(Entry):
    """What a family of causes takes off the gap beside the others."""

    name: str
    share_um: Number


class HoldoutEntry(Entry):
    """The gap at positions kept out of everything: lengths in µm, or angles in µrad."""

    rms_um: Number = None
    rms_urad: Number = None
    mean_distance_um: Number
    set_aside: list[RowEntry]
    rms_of_all_um: Number = None
    rms_of_all_urad: Number = None
    registered_rms_um: Number = None
    registered_rms_urad: Number = None
    placed_anew: str | None


class Verdict(Entry):
    """What `explain` found, as callers rely on it.

    Examples:
        >>> import sk120stiff as sk
        >>> data = sk.bundled_robots()["motoman_sk120"] / "data"
        >>> readings = sk.read(data / "table2_measured.csv")
        >>> answer = sk.explain(sk.base_model(sk.load_robot("motoman_sk120")), readings)
        >>> found = answer.document()
        >>> found.verdict, found.gap.unit, found.holdout
        ('none', 'um', None)
        >>> sorted(sk.Verdict.model_json_schema()["properties"])[:3]
        ['adequacy', 'best_guess', 'best_guess_heldout_um']
    """

    schema_version: int = Field(
        default=SCHEMA, validation_alias="schema", serialization_alias="schema", ge=2, le=2
    )
    verdict: Outcome
    remainder: RemainderEntry
    probabilities: list[OddsEntry]
    effects: list[EffectEntry]
    parameters: list[ParameterEntry]
    gap: GapEntry
    holdout: HoldoutEntry | None = None
    families: list[FamilyEntry] = Field(default_factory=list)
    next_step: str
    budget: list[ShareEntry]
    budget_joints: list[ShareEntry]
    budget_task: TaskEntry | None = None
    springs_share: Number = None
    whole_heldout_um: Number = None
    units: str | None = None
    where: list[str]
    suspects: list[SuspectEntry]
    best_guess: str | None
    best_guess_heldout_um: Number = None
    notes: list[str] = Field(default_factory=list)
    said: list[str] = Field(default_factory=list)
    not_named: list[str]
    known_together: list[str] = Field(default_factory=list)
    limits: list[str] = Field(default_factory=list)
    noise: NoiseEntry
    adequacy: AdequacyEntry | None = None
    not_observable: list[str]
    frozen: list[str] = Field(default_factory=list)
    weak_directions: list[str] = Field(default_factory=list)
    smallest_detectable: list[DetectableEntry]
    next_poses: str | None
    next_pairs: list[PairEntry] = Field(default_factory=list)

    def as_keys(self) -> dict[str, Any]:
        """The content of `verdict.json`.

        Examples:
            >>> import sk120stiff as sk
            >>> data = sk.bundled_robots()["motoman_sk120"] / "data"
            >>> readings = sk.read(data / "table2_measured.csv")
            >>> answer = sk.explain(sk.base_model(sk.load_robot("motoman_sk120")), readings)
            >>> list(answer.document().as_keys())[:3]
            ['schema', 'verdict', 'remainder']
        """
        return self.model_dump(by_alias=True)


def read_verdict(file: str | os.PathLike[str]) -> Verdict:
    """Read the `verdict.json` of `explain`.

    Args:
        file: As `explain` or ``answer.save`` wrote it.

    Returns:
        Verdict: Its keys as attributes, lengths in µm where a name ends so.

    Raises:
        InputError: It cannot be read, or is no verdict of this version.

    Examples:
        >>> import tempfile
        >>> import sk120stiff as sk
        >>> data = sk.bundled_robots()["motoman_sk120"] / "data"
        >>> readings = sk.read(data / "table2_measured.csv")
        >>> answer = sk.explain(sk.base_model(sk.load_robot("motoman_sk120")), readings)
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     written = answer.save(folder)
        ...     found = sk.read_verdict(f"{folder}/verdict.json")
        >>> found.verdict, len(found.gap.steps)
        ('none', 1)
    """
    path = Path(file)
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(
            f"no JSON can be read: {error}", where=str(path), remedy="Give a verdict.json."
        ) from error
    return validated(Verdict, content, str(path))
