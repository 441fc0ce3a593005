"""The colours of every picture and page, after Okabe and Ito: safe for colour-blind readers.

A colour stands for one thing everywhere: what is blue in a figure is blue in the scene.
"""

from __future__ import annotations

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

MEASURED: Final = BLUE
PREDICTED: Final = ORANGE
GAP: Final = VERMILION
ENHANCED: Final = GREEN
CONVENTIONAL: Final = PURPLE
NAMED: Final = "#6A3D9A"  # where a named effect acts; told from `CONVENTIONAL` by its depth
LOAD: Final = INK
NOISE: Final = "#8A96A3"

#: Colours for x, y and z wherever axes are told apart.
AXES: Final = (VERMILION, GREEN, BLUE)
#: For series without a meaning of their own, in this order.
SERIES: Final = (BLUE, ORANGE, GREEN, VERMILION, SKY, PURPLE, BLACK)


def channels(colour: str) -> tuple[float, float, float]:
    """Red, green and blue in 0..1 of ``#RRGGBB``."""
    return (
        int(colour[1:3], 16) / 255.0,
        int(colour[3:5], 16) / 255.0,
        int(colour[5:7], 16) / 255.0,
    )
