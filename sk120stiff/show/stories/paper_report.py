"""The recomputed paper as figures and as a page."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.paper import Reproduction, Verdict
from sk120stiff.paper.printed import FIGURE_POSES, data_folder
from sk120stiff.paper.setting import motion_axes
from sk120stiff.paper.tables import Column, SideBySide
from sk120stiff.show.figures import (
    Estimate,
    LoadCurve,
    definiteness_map,
    force_deflection,
    gap_per_pose,
    parameter_forest,
    relief_parts,
    surface_parts,
)
from sk120stiff.show.report import (
    Items,
    KeyFigure,
    KeyFigures,
    Note,
    Picture,
    Report,
    Section,
    Table,
    reproducibility,
)

_KINDS = {
    Verdict.REPRODUCED: "result",
    Verdict.NOT_REPRODUCIBLE: "caution",
    Verdict.WRONG: "problem",
}


def figures_of(found: Reproduction) -> dict[str, Picture]:
    """All figures by the names of their files: Table II, gaps, springs, Table IV, Figs. 4 to 9."""
    return _table2(found) | {"table4": _classes(found)} | _pulls(found) | _parts(found)


def report_of(
    found: Reproduction, tables: Sequence[SideBySide], picture: Mapping[str, Picture]
) -> Report:
    """The page that `sk120stiff paper --out` writes."""
    told: dict[str, list[str | Table]] = {t.name: [t.note, _table(t)] for t in tables}
    parts = [f"figure_{s.figure}{end}" for s in found.parts.surfaces for end in ("_surface", "")]
    gaps = [*told["table2_gaps"], picture["table2"], picture["table2_gaps"]]
    angles = (
        "Its angles follow from the robot's readings by θ1' = θ1, θ2' = θ2 + 90°, θ3' = −θ3, "
        "θ4' = θ4, θ5' = θ5, θ6' = θ6; the fixture adds 112.65 mm to D6 and is L6 = 205.32 mm."
    )
    claims: list[Note | Items] = [
        Note(
            claim.evidence,
            kind=_KINDS[claim.verdict],  # type: ignore[arg-type]
            title=f"{claim.where}: {claim.claim} {claim.verdict.value.capitalize()}",
        )
        for claim in found.claims
    ]
    more = "The CSV files beside this page hold more columns and more digits."
    folder = data_folder()
    files = [folder / "printed" / f"table{k}.csv" for k in (2, 3, 4)]
    return Report(
        title="The 2005 paper, recomputed",
        subtitle="Alici & Shirinzadeh, Enhanced Stiffness Modeling, Identification and "
        "Characterization for Robot Manipulators",
        lead="Ours beside theirs. Table II's calculated deflections come out to a fraction of a "
        "micrometre, some of the paper's numbers do not, and some of its conclusions are wrong; "
        "each claim below says which, and why.",
        sections=[
            Section("In short", [_key_figures(found), more]),
            Section("Every claim", claims),
            Section("Table II", [*gaps, *told["table2"]]),
            Section("Springs", [*told["identified"], picture["identified"]]),
            Section("Table III", told["table3"]),
            Section("Table IV", [*told["table4"], picture["table4"]]),
            Section("Critical forces", told["critical"]),
            Section("Figs. 4 to 6", [picture[f"figure_{figure}"] for figure in FIGURE_POSES]),
            Section("Figs. 7 to 9", [told["diagonal_parts"][1], *(picture[p] for p in parts)]),
            Section("Appendix I", [told["appendix"][0], angles, told["appendix"][1]]),
        ],
        reproducibility=reproducibility(
            "sk120stiff paper --out DIR", [*files, folder / "table2_measured.csv"]
        ),
    )


def _key_figures(found: Reproduction) -> KeyFigures:
    exact = 1e6 * max(found.table2.calculated_rms("equilibrium").values())
    left = 1e6 * found.identified.fit.rms
    critical = found.critical.smallest / 1e3
    counts = Counter(claim.verdict for claim in found.claims)
    return KeyFigures(
        [
            KeyFigure(
                "Table II, calculated", f"≤ {exact:.2f}", "µm rms", "ours minus theirs, per pose"
            ),
            KeyFigure("Table II, measured", f"{left:.1f}", "µm rms", "after identification"),
            KeyFigure(
                "smallest critical force", f"{critical:.0f}", "kN", "the paper says about 10"
            ),
            *(KeyFigure(f"claims {verdict.value}", str(counts[verdict])) for verdict in Verdict),
        ]
    )


def _table(table: SideBySide) -> Table:
    """A page is narrower than a CSV file: some columns stay there, and some share a cell."""
    return Table(
        header=[column.name for column in table.brief],
        rows=[*zip(*map(_cells, table.brief), strict=True)],
        caption=table.title,
        units=[column.shown_unit for column in table.brief],
        digits=6,
    )


def _cells(column: Column) -> Sequence[object]:
    """Numbers, so that they are aligned as such; words and groups of numbers as text."""
    if np.ndim(column.values) > 1:
        signs = str.maketrans({"-": "\N{MINUS SIGN}", " ": "\N{FIGURE SPACE}"})
        return [text.translate(signs) for text in column.texts]
    if not isinstance(column.values, np.ndarray):
        return column.texts
    return [*map(int if column.decimals is None else float, column.texts)]


def _table2(found: Reproduction) -> dict[str, Picture]:
    table, fitted = found.table2, found.identified
    models = {
        "paper's springs": table.ours["equilibrium"],
        "identified": table.displacement - fitted.fit.gap,
    }
    curves = [
        LoadCurve(
            title=f"pose {pose}",
            force=np.linalg.norm(table.measured.wrench[rows, :3], axis=1),
            measured=table.displacement[rows],
            models={name: moved[rows] for name, moved in models.items()},
        )
        for pose in table.printed.poses
        for rows in [table.printed.rows(pose)]
    ]
    gaps: dict[str, Array] = {
        name: np.array([*table.per_pose(table.displacement - moved).values()])
        for name, moved in models.items()
    }
    estimates = [
        Estimate(p.effect.where, float(value), float(error), "N·m/rad", reference=float(paper))
        for p, value, error, paper in zip(
            fitted.fit.parameters, fitted.springs, fitted.errors, found.setting.arm_springs,
            strict=True,
        )
    ]  # fmt: skip
    return {
        "table2": Picture(
            force_deflection(curves),
            "Measured and predicted displacement over load for the three poses of Table II.",
            "Table II: measured displacements, and the models at exact equilibrium.",
        ),
        "table2_gaps": Picture(
            gap_per_pose(table.printed.poses, gaps),
            "Root-mean-square gap per pose with the paper's and with identified springs.",
            "What the models leave of the measured column.",
        ),
        "identified": Picture(
            parameter_forest(estimates, reference_name="paper"),
            "Identified springs relative to the paper's, with two standard errors.",
            "Springs from the three printed poses, relative to the paper's from twenty.",
        ),
    }


def _classes(found: Reproduction) -> Picture:
    first, second, third = motion_axes()
    cube = found.table4.classes.reshape(-1, len(first), len(second), len(third))
    middle = int(np.argmin(np.abs(first - np.pi / 6)))
    signs = ["".join("+" if x > 0 else "−" for x in row) for row in found.table4.signs]
    return Picture(
        definiteness_map(
            second, third, np.swapaxes(cube[:, middle], 1, 2), x_label="θ2", y_label="θ3",
            titles=[f"case {k + 1}: {sign}" for k, sign in enumerate(signs)],
        ),
        "Class of K_C over joints 2 and 3 for the eight directions of force.",
        f"Classes of K_C at θ1 = {np.degrees(first[middle]):.0f}° on the grid of Table IV.",
    )  # fmt: skip


def _pulls(found: Reproduction) -> dict[str, Picture]:
    figures = {}
    for name, joints in FIGURE_POSES.items():
        curves = [
            LoadCurve(f"pulled along {pull.axis}", pull.force, models=pull.displacement)
            for pull in found.pulls
            if pull.figure == name
        ]
        readings = ", ".join(f"{angle:.4f}°" for angle in np.degrees(joints[:3]))
        figures[f"figure_{name}"] = Picture(
            force_deflection(curves),
            f"Displacement over load along three axes at the configuration of Fig. {name}.",
            f"Fig. {name}: θ1 to θ3 = {readings}. Models only: the paper's points and forces are "
            "drawn, not printed.",
        )
    return figures


def _parts(found: Reproduction) -> dict[str, Picture]:
    """Each of Figs. 7 to 9 twice: as surfaces in perspective, and as maps to read values from."""
    drawings = (("_surface", relief_parts, "as surfaces"), ("", surface_parts, "as maps"))
    figures = {}
    for s in found.parts.surfaces:
        held = f"θ{s.held[0]} = {np.degrees(s.held[1]):.0f}°"
        x, y = (f"θ{joint}" for joint in s.joints)
        for ending, draw, kind in drawings:
            figures[f"figure_{s.figure}{ending}"] = Picture(
                draw(s.x, s.y, s.parts, element=s.element, x_label=x, y_label=y),
                f"Parts of {s.element} for unit forces over two joints, {kind}.",
                f"Fig. {s.figure} {kind}: parts of {s.element} for unit forces, at {held}.",
            )
    return figures
