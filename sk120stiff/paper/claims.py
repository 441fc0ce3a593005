"""Every claim of the paper, in its order, with a verdict that follows from computed numbers."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from string import Formatter

import numpy as np

from sk120stiff.errors import listed
from sk120stiff.paper.claims_text import CLAIMS
from sk120stiff.paper.findings import Findings
from sk120stiff.paper.printed import (
    CLAIMED_CRITICAL_FORCE,
    COMPONENT,
    CONFIGURATIONS,
    LOADINGS,
    RESIDUAL_NORM,
    RESOLUTION,
)
from sk120stiff.paper.setting import rms

ROUNDING = 1e-9
CALCULATED_LIMIT = 0.3e-6  # m rms per pose: the columns are printed to 0.1 µm
_CLAIM = re.compile(r"\[(.*?)\] (.*?)\n= (?:(\w+), else )?([a-z ]+)\n(.*)", re.DOTALL)
_UNITS: dict[str, Callable[[float], object]] = {
    "k": lambda x: x / 1e3,
    "M": lambda x: x / 1e6,
    "m": lambda x: 1e3 * x,
    "u": lambda x: 1e6 * x,
    "c": lambda x: 100.0 * x,
    "s": lambda x: "0" if x == 0.0 else f"{x:.0e}",
}


class Verdict(StrEnum):
    """Three answers."""

    REPRODUCED = "reproduced"
    NOT_REPRODUCIBLE = "not reproducible"
    WRONG = "wrong"


@dataclass(frozen=True)
class Claim:
    """A claim of the paper, its section, table or equation, and what became of it, and why."""

    where: str
    claim: str
    verdict: Verdict
    evidence: str


class Words(Formatter):
    """`str.format` with units: ``!k`` is in thousands, ``!M`` in millions, ``!m`` times a thousand.

    ``!u`` is times a million, ``!c`` per cent, ``!s`` the size alone of a tiny number. Values of a
    mapping stand side by side.
    """

    def convert_field(self, value: object, conversion: str | None) -> object:
        """The value, or each of a mapping, in the unit that `conversion` names."""
        if conversion is None:
            return value
        if isinstance(value, Mapping):
            return {key: _UNITS[conversion](each) for key, each in value.items()}
        return _UNITS[conversion](value)  # type: ignore[arg-type]

    def format_field(self, value: object, format_spec: str) -> str:
        """As `format` does it; a mapping value by value."""
        if isinstance(value, Mapping):
            return " / ".join(format(each, format_spec) for each in value.values())
        return format(value, format_spec)


def claims(found: Findings) -> tuple[Claim, ...]:
    """All claims, section by section."""
    holds, values, words = decided(found), {**vars(found), **numbers(found)}, Words()
    made = []
    for block in words.vformat(CLAIMS, (), values).strip().split("\n\n"):
        match = _CLAIM.fullmatch(block)
        if match is None:
            raise ValueError(f"this claim cannot be read: {block}")
        where, claim, decider, otherwise, evidence = match.groups()
        verdict = Verdict.REPRODUCED if decider and holds[decider] else Verdict(otherwise)
        made.append(Claim(where, claim.replace("\n", " "), verdict, evidence.replace("\n", " ")))
    return tuple(made)


def decided(found: Findings) -> dict[str, bool]:
    """What must hold for a claim to be reproduced, by the words of `CLAIMS`."""
    form, forces, second, fourth = found.formulation, found.critical, found.table2, found.table4
    exact, enhanced = second.calculated_rms("equilibrium"), second.calculated_rms("enhanced")
    opposites = fourth.printed_determinant_sums.values()
    soft = found.posture.softest
    return {
        "closed": form.loop_error < ROUNDING,
        "enhanced": form.enhanced_error < 1e-6,
        "conventional": form.conventional_error > 1e-3 and form.unloaded_difference == 0.0,
        "down": found.posture.tool_error < np.radians(0.01),
        "one_minimum": found.identified.spread < 1e-5,
        "constant": found.identified.probability > 0.01,
        "calculated": max(*exact.values(), *enhanced.values()) <= CALCULATED_LIMIT,
        "on_fixture": second.variants[-1].calculated_rms_um <= 1e6 * CALCULATED_LIMIT,
        "negligible": rms(second.gap) < 3 * RESOLUTION,
        "unresolved": max(second.effect_of_K_C.values()) < RESOLUTION,
        "equal_works": found.table3.identity_error < ROUNDING,
        "violates": form.conventional_cycle > 1e-3 and form.enhanced_cycle < 1e-6,
        "no_repeat": not found.table3.repeated,
        "changes": float(soft[-1] / soft[0]) > 1.5,
        "conservative": form.force_asymmetry < ROUNDING and form.third_derivatives < 1e-6,
        "corollary": form.negative_failures == 0 and form.negative_cases > 0,
        "minors": form.minors_agree,
        "counts": bool((fourth.printed == fourth.counts).all()),
        "opposites": all(fourth.mirrored(fourth.printed).values())
        and all(total == fourth.configurations for total in opposites),
        "indefinite": int(fourth.counts[:, 4].min()) > 0,
        "positive": int(fourth.difference_positive.min()) == fourth.configurations,
        "ten_kN": 0.3 < forces.smallest / CLAIMED_CRITICAL_FORCE < 3.0,
        "diagonal": float(forces.by_diagonal.min()) >= forces.smallest * (1 - 1e-9),
        "stable": forces.smallest > 10 * CLAIMED_CRITICAL_FORCE,
        "as_printed": float(found.appendix.printed_error.max()) < ROUNDING,
        "congruent": form.congruence_failures == 0 and form.congruent_cases > 0,
    }


def numbers(found: Findings) -> dict[str, object]:
    """What the text names beside the fields of `Findings`."""
    return {**_of_table2(found), **_of_table3(found), **_of_table4(found), **_of_theory(found)}


def _of_table2(found: Findings) -> dict[str, object]:
    table, fitted = found.table2, found.identified
    off = fitted.springs / found.setting.arm_springs - 1.0
    starts = [1e3 * attempt.start for attempt in fitted.attempts]
    signs = (f"pose {pose}: {' '.join(names)}" for pose, names in table.negated.items())
    errors = zip(fitted.springs / 1e6, fitted.errors / 1e6, strict=True)
    alone = ((springs[0] / 1e6, error[0] / 1e6) for springs, error in fitted.by_pose.values())
    return {
        "configurations": CONFIGURATIONS,
        "poses": len(table.printed.poses),
        "springs": ", ".join(f"{value:.3f} ± {error:.3f}" for value, error in errors),
        "off": ", ".join(f"{100 * x:+.1f} %" for x in off),
        "attempts": len(fitted.attempts),
        "starts": (min(starts), max(starts)),
        "by_pose": ", ".join(f"{value:.2f} ± {error:.2f}" for value, error in alone),
        "residual_norm": RESIDUAL_NORM,
        "per_axis": (RESIDUAL_NORM / (CONFIGURATIONS * LOADINGS * 3)) ** 0.5 * 1e3,  # µm
        "squares": float(np.sum((1e3 * table.gap) ** 2)),  # mm²
        "gap": rms(table.gap),
        "share": rms(table.gap) / rms(table.displacement),
        "resolution": RESOLUTION,
        "resolutions": rms(table.gap) / RESOLUTION,
        "calculated": table.calculated_rms("enhanced"),
        "exact": table.calculated_rms("equilibrium"),
        "measured": table.measured_rms(),
        "most_of_K_C": max(table.effect_of_K_C.values()),
        "signs": "; ".join(signs),
        "variants": "; ".join(
            f"{v.name}: {v.calculated_rms_um:.0f} µm off calculated, {v.measured_rms_um:.0f} off "
            "measured"
            for v in table.variants[1:]
        ),
        "without": rms(table.displacement - table.ours["conventional"]),
        "with_K_C": rms(table.displacement - table.ours["enhanced"]),
    }


def _of_table3(found: Findings) -> dict[str, object]:
    table = found.table3
    theirs, ours = table.differences
    row, after = table.repeated[0] if table.repeated else (0, 0)
    others = table.printed.rows(table.printed.pose[row])
    return {
        "works": _ends(np.abs(ours)),
        "overcount": _ends(table.overcount),
        "ratio": _ends(table.ratio),
        "typical": float(np.exp(np.mean(np.log(table.ratio)))),
        "beyond": int((table.printed_cartesian > table.largest).sum()),
        "rows": len(table.work),
        "same_sign": int((np.sign(theirs) == np.sign(ours)).sum()),
        "pose": table.printed.pose[row],
        "row": row % LOADINGS + 1,
        "after": after % LOADINGS + 1,
        "F": table.printed.force[row],
        "own_work": table.work_per_force_squared[row],
        "usual": _ends(table.work_per_force_squared[others[others != row]]),
    }


def _of_table4(found: Findings) -> dict[str, object]:
    table = found.table4
    size = COMPONENT * 3**0.5
    worst = int(np.argmax(table.printed[:, 0] - table.counts[:, 0]))
    part = [str(k) for k in table.reproduced_determinant if k not in table.reproduced]
    sums, mirrored = table.printed_determinant_sums.items(), table.mirrored(table.printed).items()
    odd = [f"{i} and {k} ({total})" for (i, k), total in sums if total != table.configurations]
    return {
        "grid": table.configurations,
        "whole": " and ".join(str(case) for case in table.reproduced),
        "also": f" (in case {' and '.join(part)} the PD column alone)" if part else "",
        "worst": worst + 1,
        "true_PD": table.counts[worst, 0],
        "printed_PD": table.printed[worst, 0],
        "ours": "ours obey it, " if all(table.mirrored(table.counts).values()) else "",
        "broken": ", ".join(f"{i}/{k}" for (i, k), holds in mirrored if not holds),
        "odd": ", ".join(odd),
        "least_indefinite": int(table.counts[:, 4].min()),
        "positive": int(table.difference_positive.min()),
        "component": COMPONENT,
        "load": size,
        "load_share": size / found.critical.smallest,
    }


def _of_theory(found: Findings) -> dict[str, object]:
    slips, parts = found.appendix.slips, found.parts
    return {
        "tool_deg": float(np.degrees(found.posture.tool_error)),
        "softest": ", ".join(f"{x / 1e6:.2f}" for x in found.posture.softest_of_figures.values()),
        "parts": np.maximum(parts.highest, -parts.lowest).max(axis=1),
        "times": found.critical.smallest / CLAIMED_CRITICAL_FORCE,
        "median": found.critical.quantiles[0.5],
        "by_diagonal": float(found.critical.by_diagonal.min()),
        "slips": " and ".join(slip.element for slip in slips if slip.length == "D4"),
        "harmless": listed(sorted(slip.length for slip in slips if slip.length != "D4")),
        "printed": float(found.appendix.printed_error.max()),
        "mended": float(found.appendix.mended_error.max()),
    }


def _ends(values: np.ndarray) -> tuple[float, float]:
    return float(values.min()), float(values.max())
