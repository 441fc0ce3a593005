"""A fit in plain text, in the spirit of lmfit's report."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from sk120stiff.errors import short, two_digits
from sk120stiff.identify.checks.lack_of_fit import lack_of_fit
from sk120stiff.identify.checks.null_space import weak_directions
from sk120stiff.identify.checks.yardstick import yardstick
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.robust import far_off
from sk120stiff.measurements import Measurements

LEAST_CORRELATION = 0.3  # worth a line
MOST_LINES = 12  # of one list


def fit_report(fit: Fit, *, profile: Sequence[tuple[float, float]] | None = None) -> str:
    """Estimates with errors and intervals, statistics, noise, correlations, and what is unknown.

    Args:
        fit: A converged fit.
        profile: Profile-likelihood intervals to print in the place of the linear ones, from
            `profile_intervals`.
    """
    parts = [
        _section("Parameters", _parameters(fit, profile)),
        _section("Statistics", _statistics(fit)),
        _section("Noise", _noise(fit)),
        _section("Trusted less than the others", _down_weighted(fit)),
        _section("Far off the others", _far_off(fit)),
        _section("What these readings do not tell", weak_directions(fit)),
        _section(f"Correlations beyond {LEAST_CORRELATION}", _correlations(fit)),
    ]
    return "\n".join(part for part in parts if part)


def _section(title: str, lines: Sequence[str]) -> str:
    return "\n".join([f"[[{title}]]", *(f"    {line}" for line in lines)]) if lines else ""


def _parameters(fit: Fit, profile: Sequence[tuple[float, float]] | None) -> list[str]:
    kind = "linear" if profile is None else "profile"
    rows = [("", "value", "", "std. error", "", f"95 % ({kind})", "unit", "start")]
    starts = fit.problem.model.values[fit.problem.free]
    intervals = fit.intervals() if profile is None else profile
    for k, parameter in enumerate(fit.parameters):
        low, high = intervals[k]
        start = _number(parameter.spec.public(float(starts[k])))
        if not fit.identifiable[k]:
            cells = (parameter.name, "not identifiable", "", "", "", "")
        else:
            std, value = parameter.std, parameter.value
            error, share = ("±", _number(std)) if std is not None else ("", "on its bound"), ""
            if std is not None and np.isfinite(std) and value:
                share = f"({two_digits(100.0 * std / abs(value))} %)"
            cells = (parameter.name, _number(value), *error, share, _range(low, high))
        rows.append((*cells, parameter.spec.unit, start))
    return _aligned(rows)


def _statistics(fit: Fit) -> list[str]:
    poses = len(fit.problem.measurements.poses)
    lines = [
        f"{_count(fit)} at {poses} poses, {fit.estimated} values estimated, "
        f"{fit.degrees_of_freedom} degrees of freedom, {fit.iterations} evaluations.",
        f"Gap {short(fit.rms * 1e6)} µm rms per axis; condition {fit.condition:.3g}.",
    ]
    if fit.problem.weights is None:
        beside = "Beside what readings of a pose have in common: " if fit.problem.noise.form else ""
        lines.append(
            f"{beside}χ² = {fit.chi_square:.4g}, AIC = {fit.aic:.6g}, BIC = {fit.bic:.6g}, "
            f"log likelihood = {fit.log_likelihood:.6g}."
        )
    test = lack_of_fit(fit)
    lines += [] if test is None else [test.sentence()]
    if fit.exceeds:
        lines.append(
            f"More is left than the noise makes: √(χ²/degrees of freedom) is "
            f"{fit.noise_factor:.3g}. The standard errors are inflated by as much."
        )
    if test is not None and (said := test.of_the_statement()):
        lines.append(said)
    return lines


def _count(fit: Fit) -> str:
    readings, numbers = fit.problem.measurements.n_readings, len(fit.residual)
    if numbers == 3 * readings:
        return f"{readings} readings of three axes"
    return f"{readings} readings, {numbers} of their {3 * readings} axes read,"


def _noise(fit: Fit) -> list[str]:
    return [noise_sentence(fit), *fit.reasons]


def noise_sentence(fit: Fit) -> str:
    """What one reading is worth, where that is known from, and what the zero reading does."""
    noise = yardstick(fit)
    model = fit.problem.noise.scaled(noise.scale**0.5)
    said = noise.sentence()
    if noise.sigma is None and fit.degrees_of_freedom > 0:
        would = short(model.sigma * 1e6)
        said += f" If the model were true, it would be {would} µm for one reading."
    return f"{said} {model.of_growth_and_zero(fit.problem.measurements)}"


def _down_weighted(fit: Fit) -> list[str]:
    weights = fit.problem.weights
    if weights is None:
        return []
    rows = fit.down_weighted
    lines = [f"{len(rows)} of {len(weights)} readings."]
    for row in sorted(rows, key=lambda k: float(weights[k]))[:MOST_LINES]:
        where = place_of(fit.problem.measurements, int(row))
        lines.append(f"{where}: weight {weights[row]:.2g}")
    if len(rows) > MOST_LINES:
        lines.append(f"... and {len(rows) - MOST_LINES} more.")
    return lines


def _far_off(fit: Fit) -> list[str]:
    rows = far_off(fit)
    if not len(rows):
        return []
    size = np.sqrt(np.nansum(fit.gap**2, axis=1))
    worst = sorted(rows, key=lambda k: -float(size[k]))[:MOST_LINES]
    readings = fit.problem.measurements
    where = [f"{place_of(readings, int(k))}: {short(1e6 * size[k])} µm" for k in worst]
    one = len(rows) == 1
    return [
        f"{len(rows)} reading{' is' if one else 's are'} far off what the fit makes of the others, "
        f"and pull{'s' * one} it: --robust trusts such readings less, and a 0 in a column use "
        "leaves them out; 'explain' judges anew whether a cause may have made them.",
        *where,
    ]


def _correlations(fit: Fit) -> list[str]:
    names = [parameter.name for parameter in fit.parameters]
    upper = np.triu(np.abs(fit.correlation), k=1)
    pairs = [(int(i), int(j)) for i, j in np.argwhere(upper > LEAST_CORRELATION)]
    pairs.sort(key=lambda pair: -float(upper[pair]))
    shown = [f"{names[i]}, {names[j]}: {fit.correlation[i, j]:+.3f}" for i, j in pairs]
    if len(shown) > MOST_LINES:
        shown[MOST_LINES:] = [f"... and {len(shown) - MOST_LINES} more."]
    return shown


def place_of(measurements: Measurements, row: int) -> str:
    """A reading by its line in the file, else its number, and its pose."""
    line = int(measurements.line[row])
    where = f"line {line}" if line else f"reading {row + 1}"
    return f"{where} (pose {measurements.pose[row]})"


def _range(low: float, high: float) -> str:
    return f"{_number(low)} .. {_number(high)}"


def _number(value: float) -> str:
    return "inf" if value == np.inf else f"{value:.5g}"


def _aligned(rows: Sequence[tuple[str, ...]]) -> list[str]:
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    return list(_padded(rows, widths))


def _padded(rows: Sequence[tuple[str, ...]], widths: Sequence[int]) -> Iterator[str]:
    for row in rows:
        cells = [row[0].ljust(widths[0])]
        cells += [cell.rjust(width) for cell, width in zip(row[1:], widths[1:], strict=True)]
        yield "  ".join(cells).rstrip()
