"""The colours of every picture and page, after Okabe and Ito: safe for colour-blind readers.

A colour stands for one thing everywhere: what is blue in a figure is blue in the scene, and stays
what it is on a dark page (`DARK`).
"""

from __future__ import annotations

import re
from typing import Final

BLACK: Final = "#000000"
ORANGE: Final = "#E69F00"
SKY: Final = "#56B4E9"
GREEN: Final = "#009E73"
YELLOW: Final = "#F0E442"
BLUE: Final = "#0072B2"
VERMILION: Final = "#D55E00"
PURPLE: Final = "#CC79A7"

INK: Final = "#1B2733"  # text
SOFT_INK: Final = "#52606D"  # secondary text; 6.3:1 on white
RULE: Final = "#D5DCE3"  # lines and grids
PAPER: Final = "#FFFFFF"
WASH: Final = "#F4F6F9"  # page background

MEASURED: Final = BLUE  # readings
PREDICTED: Final = ORANGE  # what the model at hand says, its values among it
GAP: Final = VERMILION  # between the two
NOISE: Final = "#8A96A3"  # what is no more than chance
BEFORE: Final = NOISE  # the same things of an earlier model
YIELDS: Final = SKY  # what bends or moves
ENHANCED: Final = GREEN
CONVENTIONAL: Final = PURPLE
NAMED: Final = "#6A3D9A"  # where a named effect acts; told from `CONVENTIONAL` by its depth
LOAD: Final = INK

#: Lightness turned round for dark pages; hues stay. 4.5:1 on the page or better for all text.
DARK: Final = {
    BLACK: "#FFFFFE",
    INK: "#E8EDF2",
    SOFT_INK: "#A9B6C2",
    RULE: "#3A4753",
    PAPER: "#1A232C",
    WASH: "#11181F",
    NOISE: "#7F8C99",
    BLUE: "#4DB2F0",
    VERMILION: "#FF6E52",
    GREEN: "#2CC79A",
    NAMED: "#B79AE8",
}
#: From soft to stiff: as strong on white as on a dark page, and told apart by every reader.
SOFT: Final = "#C8102E"
SOFT_TO_STIFF: Final = (SOFT, "#E07B39", "#B59A5B", "#6E93AE", "#2A6FBF")


def steps(count: int) -> tuple[str, ...]:
    """Colours of the gap as a model grows in `count` steps: earlier ones grey, the last its own."""
    return (*(RULE if k % 2 else BEFORE for k in range(count - 2, -1, -1)), GAP)


def channels(colour: str) -> tuple[float, float, float]:
    """Red, green and blue in 0..1 of ``#RRGGBB``."""
    return (
        int(colour[1:3], 16) / 255.0,
        int(colour[3:5], 16) / 255.0,
        int(colour[5:7], 16) / 255.0,
    )


def style_variables() -> str:
    """The colours as CSS variables, light, and dark on a screen where the reader wants it so.

    Names of meanings and of hues alike: ``--gap`` and ``--vermilion``. Print stays light.
    """
    named = {
        name.lower().replace("_", "-"): value
        for name, value in globals().items()
        if name.isupper() and isinstance(value, str)
    }

    def block(colours: dict[str, str]) -> str:
        return ":root {" + " ".join(f"--{name}: {value};" for name, value in colours.items()) + "}"

    dark = {name: DARK[value] for name, value in named.items() if value in DARK}
    return f"{block(named)}\n@media screen and (prefers-color-scheme: dark) {{ {block(dark)} }}"


def followed(svg: str) -> str:
    """An SVG whose colours follow the page that it stands in."""
    names = {
        value.lower(): name
        for name, value in reversed(globals().items())  # the hue's own name, before its meanings
        if name.isupper() and isinstance(value, str) and value in DARK
    }

    def variable(match: re.Match[str]) -> str:
        colour = match.group(0)
        name = names.get(colour.lower())
        return colour if name is None else f"var(--{name.lower().replace('_', '-')}, {colour})"

    return re.sub(r"(?<=[: ])#[0-9a-fA-F]{6}\b", variable, svg)
