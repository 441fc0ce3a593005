"""Sizes of what was found: parameters before and after, the error budget, the curves of gears.

Before and after tell how much the missing effect had bent the joint springs, the budget what moves
the point at the measured loads, joint by joint; people recognise a gear by its curve.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np

from sk120stiff.errors import listed
from sk120stiff.explain import Explanation
from sk120stiff.explain.findings import TaskBudget
from sk120stiff.explain.judge.budget import within_joints
from sk120stiff.explain.judge.gear_curve import GearCurve, gear_curves
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.identify import Fit, unseen_reasons
from sk120stiff.model import Parameter, Share
from sk120stiff.show.figures import Estimate, parameter_forest
from sk120stiff.show.figures.budget import budget_bars
from sk120stiff.show.figures.gear_curve import gear_curve, left_out
from sk120stiff.show.report import Block, Note, Picture, Section, Table
from sk120stiff.show.wording import counted, number, percent, said_in, um, unit_of, with_error

WORTH_TELLING = 0.01
VAGUE = 0.5  # of its size, by which a value is known, from where on nothing is too soft beside it
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
    return estimates(fit, fit.parameters, _short, "Estimated parameters.")


def estimates(
    fit: Fit, parameters: Iterable[Parameter], called: Callable[[Parameter], str], caption: str
) -> Table:
    """Parameters of a fitted model, as they are called, with error and 95 % interval."""
    ends = dict(zip((p.name for p in fit.parameters), fit.intervals(), strict=True))
    unseen = unseen_reasons(fit)
    rows: list[tuple[object, ...]] = []
    for p in parameters:
        if p.name in unseen:
            rows.append((called(p), UNSEEN, None, None, unit_of(p.spec.unit)))
            continue
        low, high = ends.get(p.name, (np.nan, np.nan))
        factor, unit = said_in(p.spec.unit, p.value)
        told = (_valued(p, factor), number(factor * low), number(factor * high))
        rows.append((called(p), *told, unit))
    return Table(["parameter", "value ± standard error", "95 % from", "to", "unit"], rows, caption)


def _told(before: dict[str, Parameter], after: list[Parameter]) -> str:
    # of what they are with the effect: 3 for 12 is 75 % too soft, 12 for 3 is 300 % too stiff
    told = [p for p in after if p.value and _error(p) < VAGUE * abs(p.value) < np.inf]
    if not told:
        return "No spring is told well enough with the added effect to say how far it had been off."
    bent = [(p, before[p.name].value / p.value - 1.0) for p in told]
    bent = [(p, off) for p, off in bent if np.isfinite(off)]
    worth = sorted((b for b in bent if abs(b[1]) > WORTH_TELLING), key=lambda b: -abs(b[1]))
    if not worth:
        return (
            "The missing effect had hardly bent the springs: none changes by more than "
            f"{percent(WORTH_TELLING)}. A spring fit alone would not have betrayed it."
        )
    soft = [f"{_short(p)} {percent(-off)}" for p, off in worth if off < 0.0]
    stiff = [f"{_short(p)} {percent(off)}" for p, off in worth if off > 0.0]
    said = []
    if soft:
        said.append(f"too soft: {listed(soft)}")
    if stiff:
        said.append(f"too stiff: {listed(stiff)}")
    return (
        "Springs fitted alone cover up for what is missing. Without the added effect they had come "
        f"out {'; '.join(said)}."
    )


def _error(p: Parameter) -> float:
    return np.inf if p.std is None else p.std


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


SHOWN = 14  # shares that are drawn
SMALL = 1e-3  # of the largest share: too small to draw


def budget_section(
    answer: Explanation | Explained, at: str = "at the measured loads"
) -> Section | None:
    """Bars and a table of the shares; None where nothing moves."""
    largest = max((share.rms for share in answer.budget), default=0.0)
    shares = [share for share in answer.budget if share.rms > SMALL * largest]
    if not shares:
        return None
    drawn = shares[:SHOWN]
    told = ", ".join(f"{share.name} {um(share.rms)} µm" for share in drawn)
    return Section(
        "What moves the point",
        [
            f"Sizes {at}. The parts add as vectors: they need not add up, and "
            "where two effects are alike, what one has the other may.",
            Picture(
                lambda: budget_bars(
                    [share.name for share in drawn],
                    np.array([1e6 * share.rms for share in drawn]),
                    np.array([1e6 * (share.std or 0.0) for share in drawn]),
                    label=f"µm rms per axis {at}, ± one standard error",
                    named=[finding.effect.id for finding in answer.findings],
                ),
                alt=f"Bars of {len(drawn)} shares: {told}.",
                caption="What each effect moves the point by. Violet: what was named.",
            ),
            _shares(_rows(shares), f"Rms per axis {at}, with its standard error."),
            *_joint_by_joint(answer.joints_budget, at),
            *_task(answer.task if isinstance(answer, Explanation) else None),
        ],
    )


def _task(task: TaskBudget | None) -> list[Block]:
    """The same of a task, where one was asked for."""
    if task is None:
        return []
    named = f"`{task.path}` ({counted(task.points, 'point')})"
    if not any(share.rms for share in task.effects):
        return [f"On the task {named} nothing of the model moves the tool, or no point holds."]
    rows = _rows([share for share in task.effects if share.rms > 0.0])
    return [
        f"On the task {named} the loaded tool is moved by the arm's weight too; sizes of the "
        "uncorrected path.",
        _shares(rows, "Rms per axis along the task, with its standard error."),
        *_joint_by_joint(task.joints, "along the task"),
    ]


def _joint_by_joint(every: Sequence[Share], where: str) -> list[Block]:
    """Sums of what yields at each joint; nothing where each has its spring alone."""
    joints = [share for share in every if share.rms > 0.0]
    if not any(len(share.members) > 1 for share in joints):
        return []
    return [
        "Spring, gear and bearing of one joint trade with one another: where the parts are not "
        "known, their sum may be.",
        Table(
            ["all that yields at", "moves", "±", "together"],
            [
                (*row, " + ".join(name.partition(":")[0] for name in share.members))
                for row, share in zip(_rows(joints), joints, strict=True)
            ],
            f"Joint by joint, rms per axis {where}, with the standard error of the sum.",
            units=["", "µm", "µm", ""],
            digits=3,
        ),
    ]


def _shares(rows: list[tuple[object, ...]], caption: str) -> Table:
    return Table(["cause", "moves", "±"], rows, caption, ["", "µm", "µm"], digits=3)


def _rows(shares: Sequence[Share]) -> list[tuple[object, ...]]:
    return [(s.name, 1e6 * s.rms, "" if s.std is None else 1e6 * s.std) for s in shares]


def gear_section(answer: Explanation) -> Section | None:
    """A picture of every gear at which something was named; None where none was."""
    # Laws of one gear trade with its spring; the curve is of both together.
    within = within_joints(answer.final)
    curves = gear_curves(within, [finding.effect.id for finding in answer.findings])
    if not curves:
        return None
    blocks: list[Block] = [
        "Spring and gear together, as if the joint stood on a bench: the torque grows from zero, "
        "falls to the other side and grows back. A loop is friction, a step is play, a bend is a "
        "gear that gets stiffer. The dashed line is the plain law of the name that comes nearest."
    ]
    return Section("The curve of the gear", [*blocks, *(_picture(curve) for curve in curves)])


def _picture(curve: GearCurve) -> Picture:
    largest = 1e6 * abs(curve.twist).max()
    names = listed([f"`{name}`" for name in curve.names])
    hidden = max(left_out(curve, spring) for spring in (0.0, curve.compliance))
    outside = (
        f" {hidden} of {counted(len(curve.measured), 'reading')} lie outside what is drawn."
        if hidden
        else ""
    )
    return Picture(
        lambda: gear_curve(curve),
        alt=f"Twist of {curve.where} up to {largest:.3g} µrad over its torque up to "
        f"{abs(curve.torque).max():.3g} N·m, found curve and plain law.",
        caption=f"{curve.where}: {names}. Points: readings whose point the joint moves well."
        f"{outside}",
    )
