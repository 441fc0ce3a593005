"""What the readings of a pose have in common beyond the noise, in the fit of a base model.

No arm follows its springs to the micrometre, and what it is off by at a pose goes with every load
there: six loads are no six witnesses of a spring. Counted as such, intervals that should hold 95 %
of the springs held half of them on arms whose compliance is off by 5 % at every pose. So where
readings show such an error beyond chance it joins the noise, as it does in `explain`.
"""

from __future__ import annotations

from dataclasses import replace

from sk120stiff.errors import Refusal, short
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.solve.problem import Problem
from sk120stiff.identify.solving import solve_near
from sk120stiff.identify.uncertainty.variance_components import Components, variance_components
from sk120stiff.measurements import NoiseModel
from sk120stiff.measurements.noise.model_form import ModelForm

BY_CHANCE = 0.01  # probability up to which noise of one size is not believed to show as much
WORTH = 2.0  # gain in -2 ln L by which structure has to beat noise that is merely larger


def with_model_form(fit: Fit) -> NoiseModel:
    """The noise of a fit's readings with the model-form error that its gap asks for.

    Where a larger noise would do as well, nothing is structured, and only the size is let free.
    """
    return _noise_beside(fit.problem.noise, variance_components(fit))


def _noise_beside(noise: NoiseModel, found: Components) -> NoiseModel:
    if noise.known and found.inflation_gain > found.gain - WORTH:
        return replace(noise, form=ModelForm(), freedom=0)
    if not noise.known:
        noise = replace(noise, sigma=noise.sigma * found.noise_factor)
    return replace(noise, form=found.form)


def beside_errors_of_poses(found: Fit) -> Fit:
    """The fit beside what readings of a pose have in common; as it is where that does not show.

    One reading of a pose has nothing to have it in common with.
    """
    problem = found.problem
    readings = problem.measurements
    if len(readings.poses) == readings.n_readings or problem.noise.form or found.unit == 0.0:
        return found
    components = variance_components(found)
    noise = _noise_beside(problem.noise, components)
    if components.probability > BY_CHANCE or not noise.form:
        return found
    try:
        beside = solve_near(Problem(problem.model, readings, noise, problem.weights), found.x)
    except Refusal:
        return found
    size = noise.form.rms(readings)
    told = (
        f"Readings of one pose are off together by {short(1e6 * size)} µm rms per axis, as no "
        "law of this model makes them: values and standard errors take that into account."
    )
    return replace(beside, reasons=(*found.reasons, told))
