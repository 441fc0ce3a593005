"""The report of `demo`: the paper's measured data from springs to what three poses can tell."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sk120stiff.errors import listed
from sk120stiff.explain.candidates.absorbed import WHOLE
from sk120stiff.show.figures import (
    Estimate,
    LoadCurve,
    force_deflection,
    gap_per_pose,
    parameter_forest,
)
from sk120stiff.show.report import (
    Block,
    Code,
    Items,
    KeyFigure,
    KeyFigures,
    Note,
    Picture,
    Report,
    SceneFrame,
    Section,
    Table,
)
from sk120stiff.show.stories.demo_facts import OURS, PAPER, Demo
from sk120stiff.show.stories.evidence_section import evidence_section
from sk120stiff.show.stories.gap_pictures import on_the_arm
from sk120stiff.show.stories.gap_section import pose_rms, steps_table
from sk120stiff.show.stories.hidden_cause import HiddenCause, hidden_section
from sk120stiff.show.stories.limits_section import blind_section, next_section
from sk120stiff.show.stories.scenes import arm_views
from sk120stiff.show.stories.stiffness_section import stiffness_section
from sk120stiff.show.stories.verdicts import lead_of
from sk120stiff.show.stories.where_section import where_section
from sk120stiff.show.wording import chance, counted, number, percent, um, with_error

NAMEABLE = 5.0  # √λ at which an effect can usually be named
_SHORT = {
    "none": ("?", "these poses cannot tell"),
    "named": ("named", "verdict: named"),
    "ambiguous": ("open", "verdict: ambiguous"),
    "outside": ("outside", "no effect explains it"),
}
WORTH_LISTING = 2e-6  # m rms at its usual size


def demo_report(
    demo: Demo,
    cause: HiddenCause,
    *,
    scene: str = "",
    scene_link: str = "",
    cause_link: str = "",
    next_poses: str = "",
    reproducibility: Mapping[str, str] | None = None,
) -> Report:
    """Tell the demo as a report.

    Args:
        demo: What was computed of the paper's data.
        cause: What was found in a campaign with a hidden cause.
        scene, scene_link: Text of the scene's page, and its address beside the report.
        cause_link: Address of that campaign's own report; empty where there is none.
        next_poses: Address of the file with poses to measure next; empty where there is none.
        reproducibility: Name → text, shown last.
    """
    load_cases = demo.found.problem.load_cases
    following = next_section(demo.answer, next_poses)
    counts = f"{counted(load_cases.count, 'reading')} at {counted(len(load_cases.poses), 'pose')}"
    return Report(
        title="How stiff is a Motoman SK120, and what is missing from its model?",
        subtitle=f"Measured deflections of Table II of the 2005 paper, {counts}",
        lead=f"{demo_lead(demo)} {cause.in_short()}",
        sections=[
            _answer(demo),
            _first_act(demo),
            _second_act(demo),
            stiffness_section(demo.found),
            *([_in_space(demo, scene, scene_link)] if scene else []),
            _third_act(demo),
            _three_poses(demo),
            *([following] if following else []),
            hidden_section(cause, cause_link),
            _onwards(),
        ],
        reproducibility=reproducibility or {},
    )


def demo_lead(demo: Demo) -> str:
    """What the demo found in the paper's data, in one sentence."""
    before, after = (um(demo.rms(model)) for model in (demo.paper, demo.found.model))
    poses = counted(len(demo.found.problem.load_cases.poses), "pose")
    moved = (
        f"Springs identified from the paper's readings bring its gap from {before} to {after} µm "
        "rms per axis"
    )
    if demo.answer.verdict == "ambiguous":
        names = [f.effect.id for f in demo.answer.findings]
        names += [name for f in demo.answer.findings for name in f.alternatives]
        fitting = listed([f"`{name}`" for name in dict.fromkeys(names)], "or")
        return f"{moved}, and which of {fitting} would close the rest, {poses} cannot tell."
    if demo.answer.verdict != "none":
        return f"{moved}. {lead_of(demo.answer)}"
    if demo.noise is None or demo.chance is None:
        return f"{moved}, and whether anything is missing beyond them, {poses} cannot tell."
    return (
        f"{moved}; noise alone makes {um(demo.noise)} µm, and whether anything is missing beyond "
        f"them, {poses} cannot tell (p = {chance(demo.chance)})."
    )


def _answer(demo: Demo) -> Section:
    before, after = demo.rms(demo.paper), demo.rms(demo.found.model)
    figures = [
        KeyFigure("gap, paper's springs", um(before), "µm", "rms per axis"),
        KeyFigure("gap, identified", um(after), "µm", f"{percent(1.0 - after / before)} closed"),
    ]
    if demo.noise is not None:
        figures.append(
            KeyFigure("noise alone", um(demo.noise), "µm", f"by {demo.answer.yardstick.name}")
        )
    value, note = _SHORT[demo.answer.verdict]
    figures.append(KeyFigure("what is missing", value, "", note))
    acts = [
        "The paper's springs are put to its measured deflections.",
        "The springs are identified again, with their uncertainty.",
        "The whole catalogue of effects is asked what is missing, and what these readings could "
        "show at all.",
        "In a campaign of 20 poses a cause was hidden: it is found, and the truth opened.",
    ]
    return Section("The answer", [KeyFigures(figures), Items(acts, ordered=True)])


def _first_act(demo: Demo) -> Section:
    return Section(
        "1. The paper's springs on its data",
        [
            "The paper identified three joint springs and holds the wrist rigid. Its Table II "
            "lists deflections that a laser tracker measured; their signs were brought into one "
            "frame, as the robot's SOURCES file tells.",
            per_pose_table(demo),
            Picture(
                lambda: force_deflection(_curves(demo)),
                alt="Three panels, one for each pose: measured deflections against the load, with "
                "the lines of both models; markers and lines nearly coincide.",
                caption="Displacement against the load: readings (markers), the paper's springs "
                "and the identified ones (lines). At this scale every model looks right; the gap "
                "is what counts.",
            ),
        ],
    )


def per_pose_table(demo: Demo) -> Table:
    """Gap of both models at every pose."""
    rows: list[tuple[object, ...]] = [(f"pose {p}", b, a) for p, b, a in demo.per_pose]
    rows.append(("all", *(1e6 * demo.rms(model) for model in demo.models.values())))
    return Table(["", PAPER, OURS], rows, "Gap rms per axis.", ["", "µm", "µm"], digits=3)


def springs_table(demo: Demo) -> Table:
    """The paper's springs beside those that its readings give."""
    paper = {p.name: p.value for p in demo.paper.parameters}
    rows = []
    for p, (low, high) in zip(demo.found.parameters, demo.found.intervals(), strict=True):
        given = paper[p.name]
        change = percent(p.value / given - 1.0).replace("-", "−")
        rows.append((p.effect.where, number(1e-3 * given, 5),
                     with_error(1e-3 * p.value, 1e-3 * (p.std or 0.0)),
                     number(1e-3 * low), number(1e-3 * high), change))  # fmt: skip
    return Table(
        ["spring", "paper", "identified ± standard error", "95 % from", "to", "change"],
        rows,
        "Joint springs in kN·m/rad.",
    )


def _curves(demo: Demo) -> list[LoadCurve]:
    load_cases = demo.found.problem.load_cases
    measured = demo.found.problem.measured
    size = np.linalg.norm(load_cases.wrench[:, :3], axis=1)
    predicted = {name: model.predict(load_cases) for name, model in demo.models.items()}
    curves = []
    for k, label in enumerate(load_cases.poses):
        rows = np.flatnonzero(load_cases.pose == k)
        rows = rows[np.argsort(size[rows])]
        models = {name: values[rows] for name, values in predicted.items()}
        curves.append(LoadCurve(f"pose {label}", size[rows], measured[rows], models=models))
    return curves


def _second_act(demo: Demo) -> Section:
    found = demo.found
    paper = {p.name: p for p in demo.paper.parameters}
    gaps = {name: pose_rms(found, model) for name, model in demo.models.items()}
    apart = max(
        abs(a.value / b.value - 1.0)
        for a, b in zip(found.parameters, demo.other.parameters, strict=True)
    )
    agree = f"agree to {number(apart, 1)} of the values" if apart > 1e-15 else "agree to all digits"
    estimates = [
        Estimate(p.effect.where, p.value, p.std, p.spec.unit,
                 paper[p.name].value)
        for p in found.parameters
    ]  # fmt: skip
    ratios = "; ".join(f"{e.name} {number(e.value / (e.reference or 1), 3)}" for e in estimates)
    floor = demo.noise
    alike = (
        f"{demo.of_the_gain()} Force, springs and displacement enter as one product, so these "
        "readings do not tell softer springs from a force sensor that reads too little."
    )
    return Section(
        "2. Springs identified from these readings",
        [
            "Least squares at exact equilibrium, with the zero reading that five rows of a pose "
            "share in the covariance. The trust-region and the Levenberg–Marquardt algorithm "
            f"{agree}.",
            springs_table(demo),
            Note(alike, "caution", "Springs or force sensor"),
            Picture(
                lambda: parameter_forest(estimates, reference_name="paper's value"),
                alt=f"Identified springs as multiples of the paper's: {ratios}",
                caption="Identified springs as multiples of the paper's (grey).",
            ),
            Picture(
                lambda: gap_per_pose(found.problem.load_cases.poses, gaps, noise_floor=floor),
                alt="Bars of the gap at every pose: "
                + "; ".join(f"{n} {listed([um(float(v)) for v in g])} µm" for n, g in gaps.items()),
                caption="The gap of every pose, before and after."
                + (" Dashed: what noise alone makes." if floor is not None else ""),
            ),
            on_the_arm(arm_views(found, demo.models), " at the largest load"),
        ],
    )  # fmt: skip


def _in_space(demo: Demo, scene: str, link: str) -> Section:
    poses = counted(len(demo.found.problem.load_cases.poses), "pose")
    title = f"The SK120 at its {poses}, with ellipsoids and gap vectors"
    return Section(
        "The arm in three dimensions",
        [
            "Choose a pose and a load; ellipsoids of stiffness and compliance, with and without "
            "K_C, follow the arm.",
            SceneFrame(scene, title, "", link),
        ],
    )


def _third_act(demo: Demo) -> Section:
    answer = demo.answer
    first = answer.steps[0]
    blocks: list[Block] = [
        f"`explain` tried every effect of the catalogue. Its verdict: **{answer.verdict}**.",
        steps_table(answer),
        f"With one pose left out in turn, the springs of the other two predict it to "
        f"{um(first.heldout_rms)} µm; fitted to all they reach {um(first.fit_rms)} µm.",
    ]
    if answer.verdict == "none" and demo.noise is not None and demo.chance is not None:
        blocks.append(
            Note(
                f"The springs leave {um(first.fit_rms)} µm where the noise alone makes "
                f"{um(demo.noise)} µm (p = {chance(demo.chance)}). Something may well be missing. "
                "But a name must predict poses that it has not seen, and be told from its rivals; "
                f"with {counted(len(demo.found.problem.load_cases.poses), 'pose')} none is.",
                "caution",
                "What 'none' means here",
            )
        )
    if answer.findings:
        poses = counted(len(demo.found.problem.load_cases.poses), "pose")
        blocks.append(
            Note(
                "Folds and resamplings have no more to go by than "
                f"{poses}, and the next section tells which causes could show at all. Take a name "
                "from here as what to look for in the next campaign, not as a finding.",
                "caution",
                "Thin ground",
            )
        )
    where, evidence = where_section(answer), evidence_section(answer)
    told = evidence.blocks if answer.findings else evidence.blocks[:1]
    blocks += [Section(where.title, where.blocks), Section(evidence.title, told)]
    return Section("3. What is missing?", blocks)


def _three_poses(demo: Demo) -> Section:
    ranked = sorted(demo.hidden, key=lambda s: -s.shows)
    rows = [
        (s.effect.id, 1e6 * s.shows, percent(s.share), round(1e6 * s.remains, 3),
         round(s.visible, 1))
        for s in ranked
        if s.shows >= WORTH_LISTING
    ]  # fmt: skip
    whole = [s.effect.id for s in ranked if s.share >= WHOLE]
    able = [s for s in ranked if s.visible >= NAMEABLE]
    blocks: list[Block] = [
        "Springs that are refitted beside a missing effect cover it up. The table takes every "
        "effect at its usual size and tells what three springs would leave of it on these "
        f"readings. {len(able)} of {len(ranked)} would leave {NAMEABLE:.0f} noise standard "
        "deviations or more, about what a name needs.",
        Table(
            ["effect", "moves", "springs take", "left", "√λ"],
            rows,
            f"Effects that move the point by {um(WORTH_LISTING)} µm or more, rms per axis. √λ: "
            "what is left, in noise standard deviations over all readings.",
            ["", "µm", "", "µm", ""],
            digits=3,
        ),
    ]
    if whole:
        blocks.append(
            Note(
                f"{listed([f'`{name}`' for name in whole])}: absorbed whole. Force, displacement "
                "and springs enter as one product: a force sensor that reads 2 % too low looks "
                "exactly like springs that are 2 % softer. No further poses change that; a "
                "calibrated weight does.",
                "note",
                "Springs or sensor",
            )
        )
    blind = blind_section(demo.answer)
    return Section("What three poses can tell", [*blocks, Section(blind.title, blind.blocks)])


def _onwards() -> Section:
    return Section(
        "The same with your robot",
        [
            Code(
                "sk120stiff identify readings.csv --out model.yaml\n"
                "sk120stiff explain readings.csv --out explained\n"
                "sk120stiff paper --out paper",
                "Your readings, and all tables and figures of the paper beside ours",
            )
        ],
    )
