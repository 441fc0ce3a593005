"""Figures draw the numbers they are given, name units, and become files and page parts."""

import re
import xml.etree.ElementTree as ET

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.quiver import Quiver

from sk120stiff.errors import InputError
from sk120stiff.explain.findings import Step
from sk120stiff.show import figures as f
from sk120stiff.show import inline_svg, palette, save_figure
from sk120stiff.show.figures.scores import score_bars
from sk120stiff.show.stories.pictures import ArmView, gap_vectors

X, Y = np.linspace(-1.2, 1.2, 9), np.linspace(-2.0, 0.6, 7)
GRID = np.add.outer(Y, X)
C = np.diag([1.0, 2.0, 3.0]) * 1e-6


def every_figure() -> dict[str, Figure]:
    force = np.array([0.0, 100.0, 200.0])
    moved = np.outer(force, [1e-6, -2e-6, 3e-6])
    return {
        "force_deflection": f.force_deflection(
            [f.LoadCurve("pose 1", force, moved, np.full((3, 3), 1e-5), models={"m": moved})]
        ),
        "surface_parts": f.surface_parts(
            X, Y, np.stack([GRID, 0 * GRID, -GRID]), element="C22", x_label="q2", y_label="q3"
        ),
        "relief_parts": f.relief_parts(
            X, Y, np.stack([GRID, 0 * GRID, -GRID]), element="C22", x_label="q2", y_label="q3"
        ),
        "stiffness_slice": f.stiffness_slice(
            X, Y, 1e6 * (3.0 + GRID), x_label="q2", y_label="q3", marks={"pose 1": (0.0, -1.0)}
        ),
        "definiteness_map": f.definiteness_map(
            X, Y, (GRID > 0).astype(int) * 4, x_label="q2", y_label="q3"
        ),
        "plane_ellipses": f.plane_ellipses(
            [f.PlaneEllipse(np.array([1.0, 0.0, 0.5]), C, "pose 1")]
        ),
        "gap_per_pose": f.gap_per_pose(
            ["1", "2"], {"before": [4e-5, 3e-5], "after": [1e-5, 2e-5]}, noise_floor=1e-5
        ),
        "gap_waterfall": f.gap_waterfall(
            [Step("springs", 4e-5, 5e-5), Step("+ rocking", 1e-5, np.nan)], noise_floor=1e-5
        ),
        "posture_choice": f.posture_choice(
            np.array([1e-4, 2e-4]),
            compliance=False,
            landscape=(X, 3e-4 + 1e-4 * X**2),
            chosen=(0.0, 2e-4),
            blind=np.array([3e-4, 4e-4]),
        ),
        "parameter_forest": f.parameter_forest(
            [f.Estimate("a.b", 2.0, 0.1, "N·m/rad", 1.9), f.Estimate("c.d", 3.0, None, "m/N")]
        ),
    }


@pytest.fixture(scope="module")
def drawn() -> dict[str, Figure]:
    return every_figure()


def test_no_text_is_cut_off(drawn: dict[str, Figure], tmp_path) -> None:
    for name, figure in drawn.items():
        pixels = plt.imread(save_figure(figure, tmp_path / f"{name}.png", dpi=80))[..., :3]
        edges = [pixels[:2], pixels[-2:], pixels[:, :2], pixels[:, -2:]]
        assert all((edge == 1.0).all() for edge in edges), name
        assert (pixels < 0.9).any(), name


def test_labels_of_ticks_do_not_cover_each_other(drawn: dict[str, Figure]) -> None:
    for name, figure in drawn.items():
        renderer = FigureCanvasAgg(figure).get_renderer()
        figure.draw(renderer)
        for axes in figure.axes:
            for axis in (axes.xaxis, axes.yaxis):
                boxes = [
                    label.get_window_extent(renderer)
                    for label in axis.get_ticklabels()
                    if label.get_visible() and label.get_text()
                ]
                assert sum(box.count_overlaps(boxes) for box in boxes) <= len(boxes), name


def test_every_numeric_axis_names_its_unit(drawn: dict[str, Figure]) -> None:
    unitless = {("parameter_forest", "x"), ("gap_per_pose", "x")}  # ratios, and labels of poses
    for name, figure in drawn.items():
        said = " ".join(
            t.get_text() for axes in figure.axes for t in (axes.xaxis.label, axes.yaxis.label)
        )
        assert "[" in said or "N·m/rad per N" in said or (name, "x") in unitless, (name, said)


def test_bars_stand_for_micrometres(drawn: dict[str, Figure]) -> None:
    heights = [bar.get_height() for bar in drawn["gap_per_pose"].axes[0].patches]
    assert heights == pytest.approx([40.0, 30.0, 10.0, 20.0])
    widths = [bar.get_width() for bar in drawn["gap_waterfall"].axes[0].patches]
    assert widths == pytest.approx([40.0, 30.0, 10.0])  # first model, what is saved, second model


def test_measured_points_and_model_lines_are_the_data(drawn: dict[str, Figure]) -> None:
    axes = drawn["force_deflection"].axes[0]
    plotted = [line.get_ydata() for line in axes.lines if len(line.get_xdata()) == 3]
    assert any(np.allclose(y, [0.0, -200.0, -400.0]) for y in plotted)


def test_ellipse_is_the_compliance_times_unit_forces() -> None:
    figure = f.plane_ellipses([f.PlaneEllipse(np.zeros(3), C)], plane="xz")
    curve = max((line.get_xydata() for line in figure.axes[0].lines), key=len)
    assert np.ptp(curve[:, 1]) / np.ptp(curve[:, 0]) == pytest.approx(3.0, rel=1e-3)


def test_definiteness_uses_one_colour_for_each_class() -> None:
    figure = f.definiteness_map(X, Y, np.zeros((2, 7, 9), dtype=int), x_label="a", y_label="b")
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["positive definite"]


@pytest.mark.parametrize("ending", ["svg", "png", "pdf"])
def test_saved_as_vector_and_as_pixels(drawn: dict[str, Figure], tmp_path, ending: str) -> None:
    starts = {"svg": b"<?xml", "png": b"\x89PNG", "pdf": b"%PDF"}
    path = save_figure(drawn["gap_per_pose"], tmp_path / f"gap.{ending}")
    assert path.read_bytes().startswith(starts[ending])
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def test_other_endings_are_refused(drawn: dict[str, Figure], tmp_path) -> None:
    with pytest.raises(InputError, match=r"\.svg, \.png or \.pdf"):
        save_figure(drawn["gap_per_pose"], tmp_path / "gap.jpg")
    assert not list(tmp_path.iterdir())


def test_inline_figures_share_no_ids_and_tell_what_they_show(drawn: dict[str, Figure]) -> None:
    pages = [
        inline_svg(drawn[name], 'a "quoted" alt') for name in ("gap_per_pose", "surface_parts")
    ]
    roots = [ET.fromstring(page) for page in pages]
    ids = [element.get("id") for root in roots for element in root.iter() if element.get("id")]
    assert len(ids) == len(set(ids))
    assert all(root.get("aria-label") == 'a "quoted" alt' for root in roots)
    assert all(root.get("role") == "img" for root in roots)
    for page in pages:
        for reference in set(re.findall(r'(?:url\(|href=")#([^")]+)', page)):
            assert reference in ids


def test_the_caller_keeps_its_own_style() -> None:
    before = dict(plt.rcParams)
    every_figure()
    assert dict(plt.rcParams) == before


@pytest.mark.parametrize(
    "call",
    [
        lambda: f.surface_parts(X, Y, GRID, element="C", x_label="a", y_label="b"),
        lambda: f.stiffness_slice(X, Y, GRID.T, x_label="a", y_label="b"),
        lambda: f.gap_per_pose(["1"], {"m": [1.0, 2.0]}),
        lambda: f.LoadCurve("p", np.zeros(3), np.zeros((2, 3))),
        lambda: f.LoadCurve("p", np.zeros(3), models={"m": np.zeros((3, 2))}),
        lambda: f.plane_ellipses([], plane="xz"),
        lambda: f.gap_waterfall([]),
    ],
)
def test_arrays_that_do_not_fit_are_refused(call) -> None:
    with pytest.raises(InputError):
        call()


def _luminance(colour: str) -> float:
    linear = [
        c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4
        for c in palette.channels(colour)
    ]
    return float(np.dot([0.2126, 0.7152, 0.0722], linear))


def contrast(one: str, other: str) -> float:
    high, low = sorted([_luminance(one), _luminance(other)], reverse=True)
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("text", [palette.INK, palette.SOFT_INK])
@pytest.mark.parametrize("ground", [palette.PAPER, palette.WASH])
def test_text_has_the_contrast_that_wcag_asks_for(text: str, ground: str) -> None:
    assert contrast(text, ground) >= 4.5


@pytest.mark.parametrize(
    ("value", "std", "words"),
    [
        (3e4, np.inf, "cannot be seen"),
        (np.nan, None, "cannot be seen"),
        (np.inf, None, "rigid"),
        (3e4, 3e9, "± "),
    ],
)
def test_a_value_that_cannot_be_seen_spoils_no_picture(value, std, words) -> None:
    known = f.Estimate("joint_1", 1.0e6, 2.0e4, "N·m/rad", 1.1e6)
    hidden = f.Estimate("joint_6", value, std, "N·m/rad", 2.9e4)
    for estimates in ([known, hidden], [hidden]):
        figure = f.parameter_forest(estimates)
        figure.canvas.draw()
        (panel,) = figure.axes
        assert np.isfinite(panel.get_xlim()).all()
        assert any(words in text.get_text() for text in panel.texts)
    low, high = f.parameter_forest([known, hidden]).axes[0].get_xlim()
    assert high - low < 0.5  # what is hardly known does not squeeze what is known


def test_a_ratio_begins_at_nothing_where_none_is_negative() -> None:
    far = f.Estimate("joint_1", 4.0e6, 2.0e5, "N·m/rad", 1.0e6)
    other = f.Estimate("offset", -2e-4, 1e-5, "rad", 1e-4)
    assert f.parameter_forest([far]).axes[0].get_xlim()[0] == 0.0
    assert f.parameter_forest([far, other]).axes[0].get_xlim()[0] < -2.0


def test_candidates_stand_in_the_order_of_their_scores() -> None:
    figure = score_bars({"b": 4.0, "none of them": 250.0, "a": 0.0}, named=["a"])
    (panel,) = figure.axes
    assert [text.get_text() for text in panel.get_yticklabels()] == ["a", "b", "none of them"]
    assert [bar.get_width() for bar in panel.patches] == [0.0, 4.0, 250.0]
    assert [text.get_text() for text in panel.texts] == ["best", "+4.0", "+250"]
    with pytest.raises(InputError, match="no candidate"):
        score_bars({})


def test_a_colour_means_one_thing_in_every_figure() -> None:
    """The gap at hand is vermilion and earlier ones grey, in bars and arrows alike."""
    bars = f.gap_per_pose(["1"], {"before": [2e-5], "after": [1e-5]})
    arm = ArmView(np.array([[0.0, 0, 0], [1.0, 0, 1]]), {"before": np.ones(3), "after": np.ones(3)})
    arrows = gap_vectors([arm])
    wanted = [to_rgba(palette.BEFORE), to_rgba(palette.GAP)]
    assert [bar.get_facecolor() for bar in bars.axes[0].patches] == wanted
    drawn = [each for each in arrows.axes[0].collections if isinstance(each, Quiver)]
    assert [tuple(each.get_facecolor()[0]) for each in drawn] == wanted
    loads = np.array([100.0, 200.0])
    curve = f.LoadCurve(
        "p", loads, np.ones((2, 3)), models={"a": np.ones((2, 3)), "b": np.eye(3)[:2]}
    )
    lines = {line.get_color() for line in f.force_deflection([curve]).axes[0].lines}
    assert {palette.MEASURED, palette.PREDICTED, palette.BEFORE} <= lines
    assert not lines & {palette.GAP, palette.GREEN}
