"""What to do now that positions are explained: one paragraph for every verdict."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.errors import listed, micro
from sk120stiff.explain.findings import likely
from sk120stiff.explain.judge.borne_out import BorneOut, name_of
from sk120stiff.explain.positions.answer.balancer import tell_apart
from sk120stiff.explain.positions.answer.explained import SURE
from sk120stiff.explain.positions.judge.fallen import EVEN
from sk120stiff.explain.positions.select.candidates import family
from sk120stiff.identify.positions.residuals.pure_error import pure_error
from sk120stiff.identify.positions.words import implausible

if TYPE_CHECKING:
    from sk120stiff.explain.positions.answer.explained import Explained, Named


def headline(answer: Explained) -> str:
    """The verdict as a sentence: how many names are settled, and which are open."""
    if answer.verdict == "none" and answer.remainder is None:
        return (
            "No cause is named. The noise is not stated, so whether something is missing stays "
            "open: what is left may be noise."
        )
    if answer.verdict == "none":
        so_far = " of what was looked for" if answer.limits else ""
        return f"Model and data agree: nothing{so_far} is missing that these readings show."
    if answer.verdict == "outside":
        which = "that was looked for" if answer.limits else "of the catalogue"
        return f"Something is missing that no effect {which} explains for sure."
    left = answer.final.form is not None or answer.lacking
    more = "; more is left than noise makes" if left else ""
    if answer.off_level:
        more += "; but the arm sags to another side than its file says"
    if (held := _contradicted(answer)) is not None:
        more += f"; but {held.file} speaks against the model with what was named"
    open_ones = [item for item in answer.findings if not item.settled]
    count = len(answer.findings)
    if not open_ones:
        if count == 1:
            return f"Something was missing, and its name is settled{more}."
        return f"{count} causes were missing, each by a name that is settled{more}."
    told = "; ".join(f"{_one_of(answer, item)} ({likely(item.probability)})" for item in open_ones)
    if count == 1:
        return f"Something was missing: its name is not settled{more}. Open: {told}."
    if max(item.probability for item in answer.findings) < EVEN:
        return (
            f"Something was missing, and {count} names stand for it together, none of them likely "
            f"by itself{more}. Open: {told}."
        )
    settled = count - len(open_ones)
    named = (
        ("none of their names is", "the name of one is")[settled]
        if settled < 2
        else (f"the names of {settled} are")
    )
    return f"{count} causes were missing: {named} settled{more}. Open: {told}."


def _contradicted(answer: Explained) -> BorneOut | None:
    """What readings kept out show, where they speak against the names."""
    held = None if answer.heldout is None else answer.heldout.borne_out
    return held if held is not None and held.contradicted else None


def _one_of(answer: Explained, item: Named) -> str:
    """A name with its alternatives; those that are hardly likely are counted."""
    worth, faint = answer.rivals_of(item)
    more = [f"one of {len(faint)} that are hardly likely"] if faint else []
    return " or ".join((item.effect.id, *worth, *more))


WORSE = 2.0  # times what poses left out foretell, from where on a hold-out file is a warning
MOVED = (
    "Before anything else make sure that tracker, marker or joint moved in the middle of the file "
    "as it was taken (see what else was found): all that follows rests on it."
)

LEVEL = (
    "First settle to which side the arm sags (see what else was found): gravity, or loads that do "
    "not hang along it, moves springs and names; state it and run this again."
)


def _what_of_it(names: Collection[str], answer: Explained) -> str:
    """What to do about causes: drives yield, and that is no fault."""
    own = [item.effect for item in answer.findings if item.effect.id in names]
    if own and all(effect.joint_spring for effect in own):
        return (
            "drives yield, and that is no fault; 'sk120stiff compensate' makes up for it, and only "
            "one that is far softer than others of its size is to be looked at"
        )
    return "look there first if the arm is to be mended"


def next_step_of_positions(answer: Explained) -> str:
    """Plain sentences: what the model may be used for, and what to measure or to mend."""
    first, last = (1e6 * answer.steps[k].heldout_rms for k in (0, -1))
    unit, whole = answer.final.problem.unit, answer.final.problem.rms_unit
    use = f"Use model.yaml: at poses that no fit saw it is off by {last:.4g} {whole}"
    if last < first:
        before = answer.steps[0].label if answer.displaced else "the registered arm"
        use += f" where {before} alone is off by {first:.4g} {unit}"
    if (kept := answer.heldout) is not None and np.isfinite(kept.rms):
        use += f"; at the readings of {name_of(kept.readings)} by {micro(kept.rms, 4)}"
        if answer.findings:
            use += f" (without what was named {micro(kept.registered, 4)})"
        use += f" {kept.unit(answer.final.problem)}"
        if kept.rms > WORSE * answer.steps[-1].heldout_rms:
            use += ", much more than these readings foretell: trust it no farther than them"
    held = _contradicted(answer)
    said = [f"{use}." if held is None else held.advice(unit)]
    if far := implausible(answer.final):
        names = listed([parameter.name for parameter in far], most=3)
        beyond = f"First make sure why {names} came out larger than any arm has it"
        said.insert(
            0, f"{beyond}: elsewhere than near these poses the model may be off by as much."
        )
    said = [LEVEL, *said] if answer.off_level else said
    said = [MOVED, *said] if answer.moved else said
    named = {item.effect.id for item in answer.findings}
    most = next((share for share in answer.budget if share.name in named), None)
    if answer.displaced and most is not None:
        said.append(
            f"Of what was named {most.name} moves the point most, {micro(most.rms, 4)} µm rms per "
            f"axis: {_what_of_it({most.name}, answer)}."
        )
    elif answer.families and not answer.displaced:
        largest = max(answer.families, key=lambda name: answer.families[name])
        share = f"{micro(answer.families[largest], 4)} {unit}"
        inside = {i.effect.id for i in answer.findings if family(i.effect) == largest}
        said.append(f"What takes off most is {largest}, {share}: {_what_of_it(inside, answer)}.")
    said += dict.fromkeys(i.effect.advice for i in answer.findings if i.effect.advice)
    if answer.verdict == "ambiguous":
        if answer.following is not None:
            one, other = answer.following.between
            said.append(
                f"Measure the readings of next_poses.csv, append them to the file and run this "
                f"again: they tell {one} from {other}. Until then either name foretells alike."
            )
        elif any(item.others or item.probability < SURE for item in answer.findings):
            said.append("Take each open name as one of its class; readings of other kinds tell it.")
        said += tell_apart(answer.findings)
    if answer.guess is not None and answer.guess_heldout < answer.steps[-1].heldout_rms:
        said.append(
            f"best_guess.yaml is off by {micro(answer.guess_heldout, 4)} {unit} at poses "
            "left out: nearer, for reasons that are not confirmed."
        )
    if answer.whole is not None:
        said.append(
            "To compensate, all errors of geometry and springs together, none of them named, are "
            f"nearer: off by {micro(answer.whole, 4)} {unit} at poses left out. "
            "'sk120stiff identify DATA --out calibrated.yaml' fits them all."
        )
    if answer.verdict == "outside":
        said.append(
            "Trust it no farther than poses like those measured: more is left than the noise makes."
        )
    again = pure_error(answer.final)
    if answer.remainder is None and again is not None:
        size = micro(again.sigma)
        length, angle = f"sigma: {size}, unit: um", f"rotation: {size}, rotation_unit: urad"
        own = length if unit == "µm" else angle
        said.append(
            f"Write 'noise: {{{own}}}' into the YAML file, which the repeats show, so that what is "
            "left can be told from it."
        )
    elif answer.remainder is None:
        said.append(
            "Repeat a few poses, or state the noise, so that what is left can be told from it."
        )
    elif answer.verdict == "outside":
        said.append(
            "To learn what the rest is: repeat a few poses, approach them from both sides, and "
            "note the temperature."
        )
    return " ".join(said)
