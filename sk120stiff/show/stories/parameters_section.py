"""Parameters before and after: how much the missing effect had bent the joint springs."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sk120stiff.errors import listed
from sk120stiff.explain import Explanation
from sk120stiff.identify import Fit, unseen_reasons
from sk120stiff.model import Parameter
from sk120stiff.show.figures import Estimate, parameter_forest
from sk120stiff.show.report import Block, Note, Picture, Section, Table
from sk120stiff.show.wording import number, percent, said_in, unit_of, with_error

WORTH_TELLING = 0.01
UNSEEN = "cannot be seen"


def parameters_section(answer: Explanation) -> Section:
    """All parameters of the base model, alone and with what was added."""
    before = {p.name: p for p in answer.base.parameters}
    unseen = {**unseen_reasons(answer.base), **unseen_reasons(answer.final)}
    if not answer.findings:
        return Section("Parameters", [springs_table(answer.base), *_blind(unseen)])
    after = [p for p in answer.final.parameters if p.name in before]
    seen = [p for p in after if p.name not in unseen]
    blocks: list[Block] = [_told(before, seen), _table(before, after, unseen), *_blind(unseen)]
    drawn = [
        Estimate(_short(p), p.value, p.std, p.spec.unit, before[p.name].value)
        for p in seen
        if np.isfinite(p.value) and np.isfinite(before[p.name].value)
    ]  # fmt: skip
    if drawn:
        blocks.append(
            Picture(
                lambda: parameter_forest(drawn, reference_name="value before"),
                alt="Each parameter with its 95 % range, as a multiple of its value before: "
                + "; ".join(f"{e.name} {number(e.value / (e.reference or 1.0), 3)}" for e in drawn),
                caption="Values with the added effect, as multiples of those without it (grey).",
            )
        )
    return Section("Parameters before and after", blocks)


def springs_table(fit: Fit) -> Table:
    """Estimates with error and 95 % interval."""
    unseen = unseen_reasons(fit)
    rows: list[tuple[object, ...]] = []
    for p, (low, high) in zip(fit.parameters, fit.intervals(), strict=True):
        factor, unit = said_in(p.spec.unit, p.value)
        told: tuple[object, ...] = (UNSEEN, None, None)
        if p.name not in unseen:
            told = (_valued(p, factor), number(factor * low), number(factor * high))
        rows.append((_short(p), *told, unit))
    return Table(["parameter", "value ± standard error", "95 % from", "to", "unit"], rows,
                 "Estimated parameters.")  # fmt: skip


def _told(before: dict[str, Parameter], after: list[Parameter]) -> str:
    bent = [(p, p.value / before[p.name].value - 1.0) for p in after]
    bent = [(p, change) for p, change in bent if np.isfinite(change)]
    worth = sorted((b for b in bent if abs(b[1]) > WORTH_TELLING), key=lambda b: -abs(b[1]))
    if not worth:
        return (
            "The missing effect had hardly bent the springs: none changes by more than "
            f"{percent(WORTH_TELLING)}. A spring fit alone would not have betrayed it."
        )
    soft = [f"{_short(p)} {percent(change)}" for p, change in worth if change > 0.0]
    stiff = [f"{_short(p)} {percent(-change)}" for p, change in worth if change < 0.0]
    said = []
    if soft:
        said.append(f"too soft: {listed(soft)}")
    if stiff:
        said.append(f"too stiff: {listed(stiff)}")
    return (
        "Springs fitted alone cover up for what is missing. Without the added effect they had come "
        f"out {'; '.join(said)}."
    )


def _blind(unseen: Mapping[str, str]) -> list[Block]:
    """One paragraph on every value that these readings cannot show, and why."""
    return [Note(f"`{name}`: {why}.", "caution", "Cannot be seen") for name, why in unseen.items()]


def _table(
    before: dict[str, Parameter], after: list[Parameter], unseen: Mapping[str, str]
) -> Table:
    rows: list[tuple[object, ...]] = []
    for p in after:
        old = before[p.name]
        if p.name in unseen:
            rows.append((_short(p), UNSEEN, UNSEEN, None, unit_of(p.spec.unit)))
            continue
        factor, unit = said_in(p.spec.unit, p.value)
        change = p.value / old.value - 1.0
        rows.append(
            (
                _short(p),
                _valued(old, factor),
                _valued(p, factor),
                percent(change).replace("-", "−") if np.isfinite(change) else None,
                unit,
            )
        )
    return Table(["parameter", "before", "after", "change", "unit"], rows,
                 "Value ± standard error, without and with what was added.")  # fmt: skip


def _valued(p: Parameter, factor: float) -> str:
    return with_error(factor * p.value, None if p.std is None else factor * p.std)


def _short(p: Parameter) -> str:
    """The joint alone where it is a plain joint spring."""
    return p.effect.where if p.effect.joint_spring else p.name
