"""Where the gap of the base model lives: sentences, the line-up of suspects, the tables behind."""

from __future__ import annotations

from sk120stiff.explain import Explanation, Localisation
from sk120stiff.explain.answer.document import micrometres
from sk120stiff.show.report import Block, Items, Picture, Section, Table
from sk120stiff.show.stories.pictures import suspect_panels
from sk120stiff.show.wording import chance, percent

LISTED = 8
_WHOLE = {"excess": "what exceeds the noise", "gap": "the gap itself, noise included"}
_WORDS = {
    "world": ("x", "y", "z"),
    "arm plane": ("outwards", "sideways", "along the first axis"),
    "forearm": ("along the link", "across it, as its joint turns", "along its joint's axis"),
    "tool": ("x", "y", "z"),
}


def where_section(answer: Explanation) -> Section:
    """Where model and readings disagreed before anything was added."""
    found = answer.details.get("localisation")
    blocks: list[Block] = [Items(answer.where)]
    if isinstance(found, Localisation):
        blocks += _evidence(found)
    anything = not isinstance(found, Localisation) or found.real
    return Section("Where it lives" if anything else "Is there a gap at all?", blocks)


def _evidence(found: Localisation) -> list[Block]:
    blocks: list[Block] = []
    if found.strongest is not None and any(s.partial.size for s in found.suspects):
        best = found.suspects[0]
        blocks.append(
            Picture(
                lambda: suspect_panels(found),
                alt=f"The gap against {len([s for s in found.suspects if s.partial.size])} "
                f"suspects; the strongest is {best.name}, which takes away "
                f"{percent(best.explained)} of {_WHOLE[found.whole]}.",
                caption="The gap along the direction in which each suspect would push, against "
                "its variable; what the joint springs had covered up is put back. Grey: no more "
                "than chance.",
            )
        )
    blocks.append(_suspects(found))
    if found.real:
        blocks += [_directions(found), _levels(found), _poses(found)]
    return [block for block in blocks if not isinstance(block, Table) or block.rows]


def _suspects(found: Localisation) -> Table:
    rows = [
        (
            s.name,
            percent(s.explained),
            s.statistic,
            s.freedom,
            chance(s.probability),
        )
        for s in found.suspects[:LISTED]
    ]
    return Table(
        ["the gap goes with", "takes away", "T", "freedom", "p"],
        rows,
        f"The strongest of {len(found.suspects)} suspects, each tried alone. T: misfit that it "
        "takes away, in noise variances. p: probability that chance brings as much, corrected for "
        "all looks.",
        digits=4,
    )


def _directions(found: Localisation) -> Table:
    shares: dict[str, list[str]] = {}
    for d in found.directions:
        shares.setdefault(d.axes, []).append(percent(d.share))
    rows = [
        (axes, *(f"{word} {share}" for word, share in zip(_WORDS[axes], parts, strict=True)))
        for axes, parts in shares.items()
    ]
    return Table(
        ["axes of", "first", "second", "third"],
        rows,
        f"Where the gap points; shares of {_WHOLE[found.whole]}.",
    )


def _between(low: float, high: float) -> str:
    ends = dict.fromkeys((f"{low:.0f}", f"{high:.0f}"))
    return f"{' to '.join(ends)} N"


def _levels(found: Localisation) -> Table:
    rows = [
        (_between(level.low, level.high), level.count, 1e6 * level.rms, micrometres(level.noise))
        for level in found.levels
    ]
    return Table(
        ["load", "readings", "gap rms", "noise alone"],
        rows,
        "The gap by size of the load.",
        units=["", "", "µm", "µm"],
        digits=3,
    )


def _poses(found: Localisation) -> Table:
    ranked = sorted(found.poses, key=lambda pose: -pose.share)[:LISTED]
    rows = [
        (
            pose.label,
            1e6 * pose.rms,
            micrometres(pose.noise),
            percent(pose.share),
            chance(pose.probability),
        )
        for pose in ranked
    ]
    return Table(
        ["pose", "gap rms", "noise alone", "share", "p"],
        rows,
        f"The poses that carry most of it; shares of {_WHOLE[found.whole]}.",
        units=["", "µm", "µm", "", ""],
        digits=3,
    )
