"""What is left, what the noise is, what these readings cannot show, and what to measure next."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from sk120stiff.data_checks import place_of
from sk120stiff.effects import all_effects
from sk120stiff.explain import Detectable, Explanation
from sk120stiff.explain.answer.words import noise_words, with_set_aside
from sk120stiff.explain.findings import ENOUGH
from sk120stiff.identify.report import noise_sentence
from sk120stiff.measurements import Measurements
from sk120stiff.measurements.poses import labels_to_come
from sk120stiff.show.report import Block, Items, Note, Section, Table
from sk120stiff.show.stories.verdicts import noise_makes
from sk120stiff.show.wording import counted, number, said_in, um


def left_section(answer: Explanation, readings: Measurements) -> Section:
    """Adequacy of the final model, the noise model, and rows set aside."""
    left = answer.adequacy
    rows = [(name, number(p, 2)) for name, p in left.tests.items()]
    blocks: list[Block] = [
        f"The final model leaves {um(answer.final.rms)} µm rms per axis on the fitted readings; "
        f"{noise_makes(answer)}.",
        *([] if left.whole is None else [left.whole.sentence()]),
        " ".join([answer.remainder.sentence(), *answer.remainder.where]),
    ]
    if rows:
        blocks.append(
            Table(
                ["test", "p"],
                rows,
                "What the rest may go with. Small p: more than chance.",
                digits=2,
            )
        )
    else:
        blocks.append("The noise is unknown, so no test of what is left is possible.")
    blocks += [*answer.notes, *answer.unnamed, *answer.limits]
    blocks += [noise_sentence(answer.final), *noise_words(answer)]
    if answer.set_aside:
        blocks.append(_set_aside(answer, readings))
    return Section("What is left, and the noise", blocks)


def _set_aside(answer: Explanation, readings: Measurements) -> Note:
    slips = answer.slips
    told = [
        place_of(readings, row) + (f" ({slips[row]})" if row in slips else "")
        for row in answer.set_aside
    ]
    return Note(
        f"{counted(len(told), 'reading')} of {readings.use.sum()} no smooth cause can have made, "
        f"and no fit used: {'; '.join(told)}. Look for a disturbed reading or a slip of the pen. "
        f"Nothing was deleted. {with_set_aside(answer)}",
        "caution",
        "Set aside",
    )


def blind_section(answer: Explanation) -> Section:
    """Effects that never show here, and the smallest size of the others that would have."""
    blocks: list[Block] = [*answer.known_together]
    if answer.not_observable:
        blocks.append(
            "At no plausible size would these have shown in these readings. They may be there."
        )
        blocks.append(Items(_grouped(answer.not_observable)))
    if "reading_scale:tracker" in answer.not_observable:
        blocks.append(
            "A common factor of all forces is the same to these readings as one of all readings: "
            "every spring takes it on. A force sensor that reads 8 % too much makes all springs 8 "
            "% too stiff, and nothing here would tell."
        )
    visible = [item for item in answer.smallest_detectable if item.value is not None]
    if visible:
        blocks.append(
            Table(
                ["effect", "would have shown"],
                _sizes(answer, visible),
                "Smallest size that would have been named in four of five cases, alone or beside "
                "names that these readings cannot tell from it: a stiffness at or below the value "
                "given, anything else at or above it.",
            )
        )
    return Section("What these readings cannot show", blocks)


def _grouped(names: Sequence[str]) -> list[str]:
    """``name`` → where, where: one line for each effect."""
    places: dict[str, list[str]] = defaultdict(list)
    for full in names:
        name, _, where = full.partition(":")
        places[name].append(where)
    return [f"`{name}` at {', '.join(where)}" for name, where in places.items()]


def _sizes(answer: Explanation, visible: Sequence[Detectable]) -> list[tuple[str, str]]:
    """One row for each effect, whatever dots its place and its parameters have in their names."""
    load_cases = answer.base.problem.load_cases
    every = all_effects(
        answer.base.model.robot, poses=load_cases.poses, timed=True, catalogue=answer.catalogue
    )
    known = [effect.id for effect in every]
    by_effect: dict[str, list[Detectable]] = defaultdict(list)
    for item in visible:
        ids = [name for name in known if item.name.startswith(f"{name}.")]
        by_effect[max(ids, key=len, default=item.name.rpartition(".")[0])].append(item)
    return [(effect, _written(items)) for effect, items in by_effect.items()]


def _written(items: Sequence[Detectable]) -> str:
    if len(items) > 6:  # a constant for every pose, say: the range tells enough
        values = [float(item.value or 0.0) for item in items]
        factor, unit = said_in(items[0].unit, max(values))
        return _with(
            f"{number(factor * min(values), 3)} to {number(factor * max(values), 3)}", unit
        )
    return ", ".join(f"{item.name.rpartition('.')[2]} {_said(item)}" for item in items)


def _said(item: Detectable) -> str:
    factor, unit = said_in(item.unit, float(item.value or 0.0))
    return _with(number(factor * float(item.value or 0.0), 3), unit)


def _with(text: str, unit: str) -> str:
    return f"{text} {unit}" if unit else text


def next_section(answer: Explanation, link: str) -> Section | None:
    """Poses and loads that would settle the names, or None where nothing is open."""
    if answer.next_poses is None:
        return None
    a, wrench = answer.next_poses
    labels = labels_to_come(answer.readings.pose, len(a))
    robot = answer.final.model.robot
    units = ["mm" if slides else "deg" for slides in robot.prismatic]
    scale = np.array([1e3 if slides else np.degrees(1.0) for slides in robot.prismatic])
    rows = [
        (labels[k], *(round(float(x), 1) for x in a[k] * scale),
         *(round(float(f), 0) for f in wrench[k, :3]))
        for k in range(len(a))
    ]  # fmt: skip
    where = f" They stand in `{link}`, ready for the next campaign." if link else ""
    return Section(
        "What to measure next",
        [
            f"These {counted(len(a), 'reading')} tell the open names apart best, chosen one after "
            f"the other from 400 poses within the joint limits.{where}",
            *_pairs(answer),
            Table(
                ["reading", *robot.actuated, "fx", "fy", "fz"],
                rows,
                "Poses and forces to measure.",
                units=["", *units, "N", "N", "N"],
            ),
        ],
    )


def _pairs(answer: Explanation) -> list[Block]:
    """What the proposed readings tell, pair by pair."""
    if not answer.next_pairs:
        return []
    rows = [
        (pair.name, pair.rival, pair.apart, "yes" if pair.settled else "not for sure")
        for pair in answer.next_pairs
    ]
    return [
        Table(
            ["name", "or", "apart by", "told"],
            rows,
            "What one cannot imitate of the other at these readings, in standard deviations of "
            f"the noise; from {ENOUGH:g} on it is told which of the two it is.",
            units=["", "", "σ", ""],
            digits=2,
        )
    ]
