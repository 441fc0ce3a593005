"""One answer against one truth, by the rules of EVIDENCE.md."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from .answers import Answer, identity, identity_of
from .families import GEAR, HYSTERETIC, REVERSIBLE, family, kind

TOLD_APART = 3.3  # sqrt(lambda) below which the data cannot tell two causes apart
ALIKE = 1.0  # sqrt(lambda) below which no reading of theirs tells two causes apart
NEGLIGIBLE = 4.0  # a hidden cause this weak beyond the others need not be found


@dataclass(frozen=True)
class Mark:
    """`right` counts towards the goal, `credit` shares it among the members of a set answer,
    `wrong` counts names that do not hold the truth, `points` = credit - wrong."""

    right: float = 0.0
    wrong: int = 0
    note: str = ""
    ratio: float | None = None
    effects_covered: list[bool] = field(default_factory=list)
    springs_covered: list[bool] = field(default_factory=list)
    settled: bool | None = None
    foretold: float | None = None

    @property
    def points(self) -> float:
        return self.right - self.wrong


def true_names(truth: dict[str, Any]) -> list[str]:
    """Identities of the hidden causes."""
    return [identity(entry["name"], entry["where"]) for entry in truth["effects"]]


def mark(truth: dict[str, Any], answer: Answer) -> tuple[float, int, str]:
    """(share of the goal reached, wrong names, note)."""
    level = truth["level"]
    if truth["expected"] == "none":
        return _nothing(truth, answer)
    if level == "L7":
        return _outside(truth, answer)
    if level == "L4":
        return _pair(truth, answer)
    if level == "L5":
        return _class(truth, answer)
    if level == "L10":
        return _families(truth, answer)
    if level == "L12":
        return _beside(truth, answer)
    if level.startswith("L11"):
        return _positions(truth, answer)
    return _names(truth, answer)


def _nothing(truth: dict[str, Any], answer: Answer) -> tuple[float, int, str]:
    if answer.verdict == "none" and not answer.names:
        return 1.0, 0, ""
    if answer.verdict in {"error", "refused"}:
        return 0.0, 0, answer.verdict
    hidden = set(true_names(truth))
    # a cause that the base springs absorb may still be named, as one member of its class
    wrong = sum(1 for group in answer.effects if not group & hidden)
    if hidden and answer.names and not wrong and all(len(group) > 1 for group in answer.effects):
        return 1.0, 0, "named as a class"
    return 0.0, wrong, f"false alarm: {answer.verdict} {_spell(answer)}"


def _outside(truth: dict[str, Any], answer: Answer) -> tuple[float, int, str]:
    """No name; or, of a cause whose kind the catalogue has, its kind and place alone."""
    if answer.verdict == "outside" and not answer.names:
        return 1.0, 0, ""
    wrong = [group for group in answer.effects if not group & of_its_kind(truth)]
    if answer.effects and not wrong:
        return 1.0 / max(len(group) for group in answer.effects), 0, f"by kind: {_spell(answer)}"
    return 0.0, 1 if wrong else 0, f"{answer.verdict} {_spell(answer)}"


def of_its_kind(truth: dict[str, Any]) -> frozenset[str]:
    """Identities that name the foreign cause of a case by its kind, at its place."""
    causes = [f"{entry['name']}:{entry['where']}" for entry in truth["effects"]]
    found: set[str] = set()
    for text in (*causes, str(truth.get("foreign", ""))):
        own, _, where = text.partition(":")
        known = kind(own)
        found |= {identity(known, where)} if known else set()
    return frozenset(found)


def _names(truth: dict[str, Any], answer: Answer) -> tuple[float, int, str]:
    """Exact set; every set answer that holds a truth counts 1/size."""
    required = {
        name: entry["left"] >= NEGLIGIBLE or len(truth["effects"]) == 1
        for name, entry in zip(true_names(truth), truth["effects"], strict=True)
    }
    open_names, credit, wrong = set(required), 1.0, 0
    for group in sorted(answer.effects, key=len):
        hit = sorted(group & open_names)
        if hit:
            open_names.remove(hit[0])
            credit /= len(group)
        else:
            wrong += 1
    missed = [name for name in open_names if required[name]]
    if wrong or missed:
        return 0.0, wrong, f"{answer.verdict} {_spell(answer)}"
    return credit, 0, "" if credit == 1.0 else f"as one of a set: {_spell(answer)}"


def as_classes(truth: dict[str, Any], answer: Answer, share: float) -> float:
    """The share reached where causes that these readings cannot tell apart count as one.

    A set answer of the truth and of its aliases is all that can be said; `mark` halves it.
    """
    for entry in truth["effects"]:
        own = identity(entry["name"], entry["where"])
        alike = {
            identity(rival["name"], rival["where"])
            for rival in entry["rivals"]
            if rival["separation"] < ALIKE
        } - {own}
        for group in answer.effects:
            if own in group:
                share *= len(group) / len(group - alike)
    return min(share, 1.0)


def told_at_best(truth: dict[str, Any]) -> float:
    """The share of an answer that gives every cause as the set that these readings tell it from.

    The set holds what lies less than `TOLD_APART` of the noise from the cause; of rivals the
    nearest eight are known.
    """
    share = 1.0
    for entry in truth["effects"]:
        near = {
            identity(rival["name"], rival["where"])
            for rival in entry["rivals"]
            if rival["separation"] < TOLD_APART
        } - {identity(entry["name"], entry["where"])}
        share /= 1 + len(near)
    return share


def kin(name: str) -> frozenset[str]:
    """Identities of the whole family of an identity, at its place."""
    own, _, where = name.partition(":")
    return frozenset(identity(member, where) for member in family(own))


def _families(truth: dict[str, Any], answer: Answer) -> tuple[float, int, str]:
    """Family and place of every cause. A set answer counts one by the number of families in it; a
    second name for a gear's curve that is already named halves, and is wrong only if it speaks of
    a loop where there is none or if the right family is not named at all."""
    open_kin = {name: kin(name) for name in true_names(truth)}
    left = {n: e["left"] >= NEGLIGIBLE for n, e in zip(open_kin, truth["effects"], strict=True)}
    found: set[str] = set()
    rest: list[frozenset[str]] = []
    credit = 1.0
    for group in sorted(answer.effects, key=len):
        hit = sorted(n for n, members in open_kin.items() if group & members and n not in found)
        if hit:
            found.add(hit[0])
            credit /= len({kin(member) for member in group})
        else:
            rest.append(group)
    again = [group for group in rest if any(group & _curve(name) for name in found)]
    wrong = len(rest) - len(again)
    credit /= 2.0 ** len(again)
    missed = [name for name in open_kin if left[name] and name not in found]
    if wrong or missed:
        return 0.0, wrong, f"{answer.verdict} {_spell(answer)}"
    return credit, 0, "" if credit == 1.0 else f"not alone: {_spell(answer)}"


def _curve(name: str) -> frozenset[str]:
    """Names that describe the same gear's curve once more: a loop has a mean course too, a curve
    without a loop has no friction."""
    own, _, where = name.partition(":")
    if own not in GEAR:
        return frozenset()
    again = GEAR if own in HYSTERETIC else REVERSIBLE
    return frozenset(identity(member, where) for member in again)


def _beside(truth: dict[str, Any], answer: Answer) -> tuple[float, int, str]:
    """The known cause named, and beside it a significant remainder whose interval holds.

    Where the foreign one is named by its kind too, what is left is less than its remainder; where
    both are of one kind at one place, one name says both.
    """
    known = set(true_names(truth))
    strange = [g for g in answer.effects if g & of_its_kind(truth) and not g & known]
    rest = tuple(group for group in answer.effects if group not in strange)
    share, wrong, note = _names(truth, replace(answer, effects=rest))
    if share == 0.0:
        return share, wrong, f"{answer.verdict} {_spell(answer)}"
    told, true = answer.remainder, truth["remainder_um"]
    named = f"{_spell(answer)} named, remainder"
    if strange and told is not None and told.low <= true:
        return share / max(map(len, strange)), 0, f"the foreign one by kind: {_spell(answer)}"
    if known & of_its_kind(truth) and (told is None or told.low <= true):
        return share, 0, f"one name for both: {_spell(answer)}"
    if told is None:
        return 0.0, 0, f"{named} missing (true {true:.1f} um)"
    if not told.significant:
        return 0.0, 0, f"{named} not significant (true {true:.1f} um)"
    if not told.low <= true <= told.high:
        return 0.0, 0, f"{named} {told.low:.1f} to {told.high:.1f} um without {true:.1f}"
    return share, 0, note


def _positions(truth: dict[str, Any], answer: Answer) -> tuple[float, int, str]:
    """Exact set of what is asked for; geometry, which is off everywhere, and what hardly shows may
    be named or not."""
    if answer.verdict in {"error", "refused"}:
        return 0.0, 0, answer.verdict
    asked = {identity(e["name"], e["where"]): e["asked"] for e in truth["effects"]}
    always = {identity_of(text) for text in truth["accepted"]}
    found: set[str] = set()
    credit, wrong = 1.0, 0
    for group in sorted(answer.effects, key=len):
        hit = sorted(group & asked.keys() - found, key=lambda name: not asked[name])
        if hit:
            found.add(hit[0])
            if asked[hit[0]]:
                credit /= len(group)
        elif not group & always:
            wrong += 1
    missed = [name for name, must in asked.items() if must and name not in found]
    if wrong or missed:
        told = [g for g in answer.effects if not g & always]
        spelled = " + ".join(" or ".join(sorted(group)) for group in told)
        return 0.0, wrong, f"{answer.verdict} {spelled}, missed {' '.join(missed) or 'none'}"
    return credit, 0, "" if credit == 1.0 else f"as one of a set: {_spell(answer)}"


def at_work(truth: dict[str, Any], group: frozenset[str]) -> bool:
    """Whether one of these names is truly at work; at L10 the family counts, at L5 the class, of
    foreign causes the kind."""
    names = true_names(truth)
    if truth["level"] == "L5" or truth["level"].startswith("L11"):
        names += [identity_of(text) for text in truth["accepted"]]
    if truth["level"] == "L10":
        names = [member for name in names for member in kin(name)]
    return bool(group & {*names, *of_its_kind(truth)})


def _pair(truth: dict[str, Any], answer: Answer) -> tuple[float, int, str]:
    """'A or B' with poses to settle it; a lone right name counts only if the data allow it."""
    own, entry = true_names(truth)[0], truth["effects"][0]
    near = {
        identity(r["name"], r["where"])
        for r in entry["rivals"]
        if r["separation"] < 1.5 * TOLD_APART
    }
    partner = {identity_of(text) for text in truth["pair"]}
    wrong = sum(1 for group in answer.effects if own not in group)
    holding = [group for group in answer.effects if own in group]
    if wrong or len(holding) != 1:
        return 0.0, wrong, f"{answer.verdict} {_spell(answer)}"
    group = holding[0]
    if len(group) == 1:
        return 0.0, 0, f"right by luck: {_spell(answer)} alone"
    if not group & (partner | near):
        return 0.0, 0, f"the wrong company: {_spell(answer)}"
    if answer.verdict != "ambiguous" or not answer.next_poses:
        return 0.5, 0, "no poses that settle it"
    stray = len(group - near - partner - {own})
    return (1.0, 0, "") if stray == 0 else (1.0 / (1 + stray), 0, f"too many: {_spell(answer)}")


def _class(truth: dict[str, Any], answer: Answer) -> tuple[float, int, str]:
    """The whole class, never one member alone."""
    members = {identity_of(text) for text in truth["accepted"]}
    holding = [group for group in answer.effects if group & members]
    wrong = len(answer.effects) - len(holding)
    if len(holding) == 1 and not wrong and holding[0] >= members:
        return 1.0, 0, ""
    return 0.0, wrong, f"{answer.verdict} {_spell(answer)}"


def _spell(answer: Answer) -> str:
    return " + ".join(" or ".join(sorted(group)) for group in answer.effects)


def coverage(truth: dict[str, Any], answer: Answer, share: float) -> tuple[list[bool], list[bool]]:
    """Do the 95 % intervals of effect parameters and of base springs hold the truth?

    Only asked where the named set is exactly right: elsewhere the model is another one. At L10
    springs of gears without a curve of their own alone: the rest is true of no law of the product.
    """
    if share < 1.0 or truth["level"] in {"L5", "L7"}:
        return [], []
    effects, springs = [], []
    exact = [] if truth["level"] == "L10" else truth["effects"]
    for entry in exact:
        own = identity(entry["name"], entry["where"])
        effects += [
            _inside(answer, f"{own}.{short}", value)
            for short, value in entry["quantities"].items()
            if f"{own}.{short}" in answer.parameters
            # of a play with flanks too it is a part alone
            and not any(name.startswith(f"{own}.{short}_") for name in answer.parameters)
        ]
    # a gear's curve of another law has no spring of its own that could be right
    bent = {e["where"] for e in truth["effects"] if truth["level"] == "L10" and e["name"] in GEAR}
    for joint, stiffness in truth["springs"].items():
        if joint in bent:
            continue
        key = f"joint_springs:{joint}.stiffness"
        meant = _meant_by_its_law(truth, answer, joint, stiffness)
        found = answer.parameters.get(key)
        if found is None or meant is None:
            continue
        # of positions: a spring that has no name stands in the model as not known, without an error
        unnamed = truth["level"].startswith("L11") and found.std is None
        if not (unnamed and math.isinf(found.value)):
            springs.append(_inside(answer, key, meant))
    return effects, springs


def _meant_by_its_law(
    truth: dict[str, Any], answer: Answer, joint: str, stiffness: float
) -> float | None:
    """What the answer's law of a hardening gear calls its spring, where the truth has one.

    Of a series (k2, k3) it is the stiffness about no torque; of steps it is that beyond the last
    one, as the generator has it, whose cubic law has no such thing.
    """
    gears = [e for e in truth["effects"] if (e["name"], e["where"]) == ("gear_hardening", joint)]
    if not gears:
        return stiffness
    sizes = gears[0]["sizes"]
    stepped = any(
        name.startswith(f"gear_hardening:{joint}.extra_below") for name in answer.parameters
    )
    if stepped:
        return None if "cubic" in sizes else stiffness
    return stiffness / (1.0 + sizes.get("first", 0.0) + sizes.get("second", 0.0))


def _inside(answer: Answer, key: str, value: float) -> bool:
    found = answer.parameters[key]
    return found.std is not None and abs(found.value - value) <= 1.96 * found.std


def heldout_ratio(truth: dict[str, Any], predicted: np.ndarray | None) -> float | None:
    """Expected error on sealed readings over that of the truth itself; None without predictions."""
    if predicted is None or not predicted.size or predicted.shape != np.shape(truth["oracle"]):
        return None
    miss = 1e6 * np.sqrt(np.mean((predicted - np.array(truth["oracle"])) ** 2))
    floor = truth["sealed_sigma_um"]
    return float(np.hypot(floor, miss) / floor)


def foretold(
    truth: dict[str, Any], predicted: np.ndarray | None, std: np.ndarray | None
) -> float | None:
    """Share of 95 % intervals at sealed readings that hold the true value; None: none are told."""
    if predicted is None or std is None or predicted.shape != np.shape(truth["oracle"]):
        return None
    told = np.isfinite(std)
    miss = np.abs(predicted - np.array(truth["oracle"]))
    return float((miss <= 1.96 * std)[told].mean()) if told.any() else None
