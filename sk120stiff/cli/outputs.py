"""Folders and pages that a command leaves: complaints before the work, no answer lost behind it."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from sk120stiff.errors import InputError, require
from sk120stiff.files import will_write, write_atomically

if TYPE_CHECKING:
    from sk120stiff.show import Report, Scene


def will_show(page: Path | None, option: str = "--page") -> None:
    """Declare a page before the work; None asks for nothing.

    Raises:
        InputError: Its name does not end in .html, or it cannot be written.
    """
    will_write(page, option)
    if page is not None and page.suffix.lower() not in (".html", ".htm"):
        wrong = "would overwrite" if page.exists() else "cannot be named"
        raise InputError(
            f"a page {wrong} {page.name}, which does not end in .html: a browser would not open it",
            where=option,
            remedy=f"Choose another name, like {page.stem}.html; a browser prints it as PDF.",
        )


def will_draw(*wanted: object) -> None:
    """Complain of pictures that cannot be drawn; None asks for nothing.

    Raises:
        MissingPart: A library that draws is not installed.
    """
    if any(each is not None for each in wanted):
        for library in ("matplotlib", "meshcat", "tornado"):
            require(library, needed_for="drawing")


def will_write_into(out: Path, names: Iterable[str]) -> None:
    """Complain of a folder that files of these names cannot be written into.

    Raises:
        InputError: It is a file, or no folder that may be written to; a file of it is an input.
    """
    if out.exists() and not out.is_dir():
        raise InputError(
            "this is a file, not a folder", where=str(out), remedy="Name another folder."
        )
    there = next(folder for folder in (out, *out.absolute().parents) if folder.exists())
    if not os.access(there, os.W_OK | os.X_OK):
        raise InputError(
            f"cannot write into {there}",
            where=str(out),
            remedy="Choose a folder that you may write to.",
        )
    for name in names:
        will_write(out / name)


def refuse_foreign(out: Path, names: Iterable[str], *, ours: bool) -> None:
    """Replace files of an earlier run alone; is the folder `ours`, an earlier run's?"""
    for name in names:
        if not ours and (out / name).exists():
            raise InputError(
                f"{name} is here and is not of an earlier run, so it is not replaced",
                where=f"--out {out}",
                remedy="Choose another folder, or move the file.",
            )


def write_pages(
    out: Path, scene: Callable[[], Scene], report: Callable[[str], Report]
) -> dict[str, Path]:
    """Write `scene.html`, and `report.html` with its text in it, each where it can be made."""
    from sk120stiff.show import scene_html

    text = _page_or_warning("scene.html", lambda: scene_html(scene()))
    written = {} if text is None else {"scene": write_atomically(out / "scene.html", text)}
    page = _page_or_warning("report.html", lambda: report(text or "").html())
    if page is not None:
        written["report"] = write_atomically(out / "report.html", page)
    return written


def _page_or_warning(name: str, make: Callable[[], str]) -> str | None:
    """Text of a page; None, with a warning, where it cannot be made."""
    from sk120stiff.show.report import failure

    try:
        return make()
    except Exception as error:  # noqa: BLE001  (an answer is never lost to its page)
        failure(f"the page {name}", error)
        return None
