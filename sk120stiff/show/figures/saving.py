"""Figures as files and as parts of a page."""

from __future__ import annotations

import io
import os
import re
from html import escape
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING

from sk120stiff.errors import InputError
from sk120stiff.files import write_atomically
from sk120stiff.show import palette

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMATS = ("svg", "png", "pdf")
_numbers = count(1)
_PIXELS_PER_INCH = 105.0  # on a page; a figure as wide as the text then fills it


def save_figure(figure: Figure, path: str | os.PathLike[str], *, dpi: int = 200) -> Path:
    """Write a figure as SVG, PNG or PDF, by the ending of the name; never half a file.

    Raises:
        InputError: The name ends in something else.
    """
    target = Path(path)
    kind = target.suffix.lstrip(".").lower()
    if kind not in FORMATS:
        raise InputError(
            f"a figure cannot be written as {target.suffix or 'a name without an ending'}",
            where=str(target),
            remedy="Choose a name that ends in .svg, .png or .pdf.",
        )
    return write_atomically(target, _rendered(figure, kind, dpi))


def inline_svg(figure: Figure, alt: str) -> str:
    """The figure as an `<svg>` element that a screen reader announces as `alt`.

    Ids are made unique, so that many figures can stand in one page, and its colours are the page's.
    """
    svg = _rendered(figure, "svg", 72).decode("utf-8")
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    prefix = f"f{next(_numbers)}-"
    svg = re.sub(r'\bid="', f'id="{prefix}', svg)
    svg = re.sub(r'href="#', f'href="#{prefix}', svg)
    svg = palette.followed(re.sub(r"url\(#", f"url(#{prefix}", svg))
    opening, rest = svg.split(">", 1)
    opening = re.sub(r'\s(width|height)="[^"]*"', "", opening)
    widest = _PIXELS_PER_INCH * figure.get_figwidth()
    opening += f' style="max-width: {widest:.0f}px"'  # a narrow figure is not blown up
    return f'{opening} role="img" aria-label="{escape(alt, quote=True)}">{rest}'


def _rendered(figure: Figure, kind: str, dpi: int) -> bytes:
    from sk120stiff.show.figures.style import styled

    stamp = {"svg": {"Date": None, "Creator": "sk120stiff"}, "pdf": {"CreationDate": None}}
    buffer = io.BytesIO()
    with styled():
        figure.savefig(
            buffer,
            format=kind,
            dpi=dpi,
            bbox_inches="tight",
            pad_inches=0.08,
            metadata=stamp.get(kind),
        )
    return buffer.getvalue()
