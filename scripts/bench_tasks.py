"""What `bench.py` measures beside the kernel: the waiting times of the main jobs."""

from __future__ import annotations

import json
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from itertools import count as count_from
from pathlib import Path

import numpy as np

from sk120stiff import load_robot
from sk120stiff.measurements import Measurements, NoiseModel, read_measurements
from sk120stiff.model import Model, base_model

TABLE_2 = Path(__file__).resolve().parents[1] / "robots/motoman_sk120/data/table2_measured.csv"


def seconds(work: Callable[[], object], budget: float) -> float:
    """Shortest time of one call, of as many as fit into the budget, at least two."""
    work()
    best, end, runs = np.inf, time.perf_counter() + budget, 0
    while runs < 1 or time.perf_counter() < end:
        begin = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - begin)
        runs += 1
    return best


def sk120_model() -> Model:
    """The paper's springs."""
    model = base_model(load_robot("motoman_sk120"))
    if model is None:
        raise FileNotFoundError("model.yaml of motoman_sk120")
    return model


def readings(count: int, model: Model) -> Measurements:
    """`count` simulated readings of random poses, five loads each, 10 µm of noise."""
    from sk120stiff.plan import simulate

    rng = np.random.default_rng(0)
    robot = model.robot
    head = ["pose", *(f"{joint}[rad]" for joint in robot.actuated), "fx[N]", "fy[N]", "fz[N]"]
    lines = [",".join(head)]
    for pose in range(-(-count // 5)):
        a = rng.uniform([-2.5, -0.9, -1.5, -0.5, -1.5, -0.5], [2.5, 0.9, 0.4, 0.5, 0.0, 0.5])
        direction = rng.normal(size=3)
        for load in range(5):
            force = direction / np.linalg.norm(direction) * 98.0 * (load + 1)
            lines.append(",".join([f"p{pose}", *map(repr, [*a.tolist(), *force.tolist()])]))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "plan.csv"
        path.write_text("\n".join(lines[: count + 1]) + "\n")
        settings = (
            "robot: motoman_sk120\nforce: {frame: base}\n"
            "displacement: {frame: base, zero: separate}\nnoise: {sigma: 10, unit: um}\n"
        )
        path.with_suffix(".yaml").write_text(settings)
        plan = read_measurements(path, robot.actuated)
    return simulate(model, plan, noise=NoiseModel(10e-6), seed=1).measurements


def identification(count: int, budget: float) -> float:
    """Springs of three joints from `count` readings [s]."""
    from sk120stiff.identify import fit

    model = sk120_model()
    data = readings(count, model)
    start = model.with_values(model.values * 2.0)
    return seconds(lambda: fit(start, data), budget)


def prediction(count: int, budget: float) -> float:
    """Exact equilibrium of `count` readings [s]."""
    from sk120stiff.effects import load_cases_of

    model = sk120_model()
    load_cases = load_cases_of(model.robot, readings(count, model))
    return seconds(lambda: model.predict(load_cases), budget)


def sensitivities(budget: float) -> float:
    """Exact derivatives of 100 readings by the parameters of springs, base and link [s]."""
    from sk120stiff.effects import effect, load_cases_of

    model = sk120_model()
    load_cases = load_cases_of(model.robot, readings(100, model))
    for name, where in (("base_rocking", None), ("link_bending", "link_3_u")):
        model = model + effect(model.robot, name, where)
    factors = count_from(1)  # other values every time: the last ones are remembered

    def work() -> None:
        model.predict_with_sensitivities(load_cases, (1.0 + 1e-6 * next(factors)) * model.values)

    return seconds(work, budget)


def slip_search(count: int) -> float:
    """Slips of the pen sought in `count` sound readings [s]."""
    from sk120stiff.data_checks import find_slip

    model = sk120_model()
    data = readings(count, model)
    begin = time.perf_counter()
    find_slip(model.robot, data)
    return time.perf_counter() - begin


def explanation(count: int, candidates: int, remainder: float = 0.0) -> float:
    """What is missing, from `count` readings with a rocking base, and some candidates [s].

    `remainder` is what no law explains: each pose is so much softer or stiffer, as real arms are.
    """
    from sk120stiff.effects import effect
    from sk120stiff.explain import Options, explain

    model = sk120_model()
    rocking = effect(model.robot, "base_rocking", "base_link")
    true = model + rocking
    values = true.values.copy()
    values[-len(rocking.parameters) :] = [spec.typical for spec in rocking.parameters]
    data = readings(count, true.with_values(values))
    own = 1.0 + remainder * np.random.default_rng(1).normal(size=len(data.poses))
    data = replace(data, displacement=data.moved * own[data.pose_index, None])
    names = ("base_rocking", "base_sliding", "joint_tilt", "link_bending", "tool_compliance",
             "force_bias", "reading_rotation", "closure_coupling")  # fmt: skip
    options = Options(only=names[:candidates]) if candidates else Options()
    begin = time.perf_counter()
    explain(model, data, options=options)
    return time.perf_counter() - begin


def table_2_identification(budget: float) -> float:
    """The paper's measured data, read and identified [s]."""
    from sk120stiff.identify import fit

    model = sk120_model()
    return seconds(lambda: fit(model, read_measurements(TABLE_2, model.robot.actuated)), budget)


def live_frame(budget: float) -> float:
    """From a request of the live page to the answer, without the network [s]."""
    from sk120stiff.show.live.messages import read_request
    from sk120stiff.show.live.server import LiveServer
    from sk120stiff.show.scene.building import scene_of_model

    server = LiveServer(scene_of_model(sk120_model()), port=0)
    request = {
        "id": 1,
        "a": [0.1, 0.2, -0.3, 0.0, -0.9, 0.0],
        "wrench": [100.0, 0.0, -400.0, 0.0, 0.0, 0.0],
        "point": [0.0, 0.0, 0.0],
        "exaggeration": 100.0,
    }

    def answer() -> str:
        _, asked = read_request(json.dumps(request), server.bounds)
        return json.dumps(server.frame(asked))

    try:
        return seconds(answer, budget)
    finally:
        for one in server._listening:
            one.close()
