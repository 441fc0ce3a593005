"""`sk120stiff paper`."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from rich import box
from rich.padding import Padding
from rich.table import Table

from sk120stiff.cli.frame import Answer, note
from sk120stiff.cli.options import OutFolderOption
from sk120stiff.cli.outputs import refuse_foreign, will_draw, will_write_into
from sk120stiff.cli.tables import progress_bar, table
from sk120stiff.files import together, write_atomically
from sk120stiff.paper import Reproduction, Verdict, reproduce
from sk120stiff.paper.tables import SideBySide, as_document, side_by_side

REPORT = "report.html"
MARK = b'name="generator" content="sk120stiff"'
_COLOURS = {
    Verdict.REPRODUCED: "green",
    Verdict.NOT_REPRODUCIBLE: "yellow",
    Verdict.WRONG: "red",
}


def command(out: OutFolderOption = None) -> Answer:
    """The 2005 paper's tables, figures, claims: ours beside theirs.

    With --out DIR: report.html, every figure as SVG and PNG, every table as CSV.

    Example: sk120stiff paper --out paper
    """
    if out is not None:
        will_write_into(out, [REPORT])
        will_draw(out)
    with progress_bar("recomputing the paper") as report:
        found = reproduce(report)
    tables = side_by_side(found)
    files = [] if out is None else _write(found, tables, out)
    document = {**as_document(found), "files": files}
    parts: list[object] = []
    for each in tables:
        if each.name == "claims":
            parts.append(_claims(found))
            continue
        parts += [_printable(each), Padding(each.note, (0, 0, 1, 0))]
    parts.append(_summary(found))
    if out is not None:
        parts.append(f"Report: {out / 'report.html'}")
    return Answer(document, parts)


def _write(found: Reproduction, tables: tuple[SideBySide, ...], out: Path) -> list[Path]:
    from sk120stiff.show import save_figure
    from sk120stiff.show.stories.paper_report import figures_of, report_of

    with progress_bar("writing the report") as report, together(last=out / REPORT):
        figures = figures_of(found)
        names = [f"{name}.{end}" for name in figures for end in ("svg", "png")]
        ours = (out / REPORT).is_file() and MARK in (out / REPORT).read_bytes()[:2000]
        made = [REPORT, *names, *(f"{each.name}.csv" for each in tables)]
        refuse_foreign(out, made, ours=ours)
        total, files = len(names) + 1, []
        for name in names:
            files.append(save_figure(figures[Path(name).stem].drawn, out / name))
            report(len(files), total)
        files += [write_atomically(out / f"{each.name}.csv", each.csv()) for each in tables]
        files.append(report_of(found, tables, figures).write(out / REPORT))
        report(total, total)
    note(f"{len(files)} files written to {out}.")
    return files


def _printable(shown: SideBySide) -> Table:
    """Numbers that belong together share a column, and some columns are left to the CSV file."""
    heads = [c.name + (f"\n{c.shown_unit}" if c.unit else "") for c in shown.brief]
    return table(shown.title, heads, zip(*(c.texts for c in shown.brief), strict=True))


def _claims(found: Reproduction) -> Table:
    made = Table(title="Every claim", title_justify="left", box=box.SIMPLE_HEAD, show_edge=False)
    made.add_column("verdict", no_wrap=True)
    made.add_column("where", overflow="fold", max_width=12)
    made.add_column("claim, and what was found", overflow="fold")
    for claim in found.claims:
        made.add_row(claim.verdict.value, claim.where, claim.claim, style=_COLOURS[claim.verdict])
        made.add_row("", "", claim.evidence)
    return made


def _summary(found: Reproduction) -> str:
    counts = Counter(claim.verdict for claim in found.claims)
    told = ", ".join(f"{counts[verdict]} {verdict.value}" for verdict in Verdict)
    return f"{len(found.claims)} claims: {told}."
