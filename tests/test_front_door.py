"""`import sk120stiff as sk`: the names are there whatever was imported before, and examples run."""

from __future__ import annotations

import doctest
import inspect
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import FunctionType

import numpy as np
import pytest

import sk120stiff as sk

VERBS = ("compensate", "explain", "fit", "load_robot", "plan", "predict", "read", "read_model",
         "simulate", "stiffness")  # fmt: skip
FINDER = doctest.DocTestFinder(recurse=False)
FLAGS = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS


def public() -> dict[str, object]:
    """Every public name, and every public method of the classes among them."""
    found: dict[str, object] = {}
    for name in sk.__all__:
        item = found[name] = getattr(sk, name)
        for base in item.__mro__ if inspect.isclass(item) else ():
            if base.__module__.startswith("sk120stiff."):
                methods = {key: value for key, value in vars(base).items() if key[0] != "_"}
                for key, value in methods.items():
                    if isinstance(value, FunctionType | classmethod | staticmethod):
                        found.setdefault(f"{name}.{key}", getattr(item, key))
    return {name: item for name, item in found.items() if name != "CATALOGUE"}


# What the program asks of an effect; whoever writes one finds it in docs/howto/own_effect.md.
CONTRACT = {f"Effect.{name}" for name in (
    "applies_to", "at", "laws_at_positions", "nearby_laws", "options_of", "other_laws", "sample",
)}  # fmt: skip
PUBLIC = {name: item for name, item in public().items() if name not in CONTRACT}


def test_methods_are_among_what_is_public() -> None:
    assert {"Fit.to_frame", "Measurements.from_frame", "Explanation.report"} < set(PUBLIC)
    assert set(public()) > CONTRACT


@pytest.mark.parametrize("name", PUBLIC)
def test_the_example_in_the_docstring_runs(name: str) -> None:
    (example,) = FINDER.find(inspect.unwrap(PUBLIC[name]), name, globs={})
    assert example.examples, f"{name} has no example"
    said: list[str] = []
    failed = doctest.DocTestRunner(optionflags=FLAGS).run(example, out=said.append)
    assert not failed.failed, "".join(said)


def test_the_first_page_runs() -> None:
    failed, tried = doctest.testmod(sk)
    assert tried > 2 and not failed


def test_every_verb_has_a_full_signature() -> None:
    for name in VERBS:
        verb: Callable[..., object] = getattr(sk, name)
        signature = inspect.signature(verb)
        assert signature.return_annotation is not inspect.Signature.empty
        for parameter in signature.parameters.values():
            assert parameter.annotation is not inspect.Parameter.empty, (name, parameter.name)


@pytest.mark.parametrize(
    "before",
    [
        "",
        "import sk120stiff.{name}",
        "from sk120stiff.{name} import *",
        "sk.{name}",
        "import importlib; importlib.import_module('sk120stiff.{name}')",
        "import sk120stiff.cli.main, sk120stiff.explain, sk120stiff.workspace",
    ],
)
def test_a_folder_never_hides_the_verb_of_its_name(before: str) -> None:
    code = "import sk120stiff as sk, sys\n" + "".join(
        f"{before.format(name=name)}\n"
        f"from sk120stiff import {name}\n"
        f"assert callable(sk.{name}) and sk.{name} is {name}, sk.{name}\n"
        f"import sk120stiff.{name}\n"
        f"from sk120stiff.{name} import __all__ as inside\n"
        f"assert sk.{name} is {name} and inside\n"
        f"assert sys.modules['sk120stiff.{name}'].__name__ == 'sk120stiff.{name}'\n"
        for name in ("plan", "stiffness", "explain")
    )
    done = subprocess.run(
        [sys.executable, "-W", "error::ImportWarning", "-c", code], capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="explane"):
        _ = sk.explane


def test_every_answer_prints_in_a_line(tmp_path: Path) -> None:
    """An array of a thousand numbers is no answer to who prints it."""
    model = sk.base_model(sk.load_robot("ur5e"))
    pose, load = [0.0, -1.0, 1.0, 0.0, 1.0, 0.0], [0.0, 0.0, -50.0, 0.0, 0.0, 0.0]
    plan = sk.plan(model, 4, point=[0.0, 0.06, 0.08], force=60.0)
    made = sk.simulate(model, plan, noise=sk.NoiseModel(1e-5), seed=1)
    answers = {
        "N/µm": sk.stiffness(model, pose, load),
        "µm off before": sk.compensate(model, [pose], [load]),
        "4 readings, up to": sk.predict(model, made.measurements),
        "0 outliers": made,
        "lines of text": sk.export(model, tmp_path / "arm.urdf"),
    }
    for told, answer in answers.items():
        assert told in repr(answer)
        assert len(repr(answer)) < 200


def test_a_load_is_a_wrench_or_a_force_alone_everywhere() -> None:
    model = sk.base_model(sk.load_robot("ur5e"))
    pose = [0.0, -1.0, 1.0, 0.0, 1.0, 0.0]
    force, wrench = [3.0, 0.0, -50.0], [3.0, 0.0, -50.0, 0.0, 0.0, 0.0]
    one, two = (sk.stiffness(model, pose, load) for load in (force, wrench))
    np.testing.assert_array_equal(one.deflection_equilibrium, two.deflection_equilibrium)
    np.testing.assert_array_equal(model.deflect(pose, force), model.deflect(pose, wrench))
    for wrong in ([0.0, -50.0], [[0.0] * 6] * 3, [0.0, 0.0, float("nan"), 0.0, 0.0, 0.0]):
        for ask in (
            lambda load: sk.stiffness(model, pose, load),
            lambda load: sk.compensate(model, [pose, pose], load),
            lambda load: model.deflect([pose, pose], load),
        ):
            with pytest.raises(sk.InputError, match="wrench"):
                ask(wrong)


def test_a_plan_has_a_positive_force_and_noise() -> None:
    model = sk.base_model(sk.load_robot("ur5e"))
    for wrong in ({"force": -1.0}, {"sigma": 0.0}):
        with pytest.raises(sk.InputError, match="positive"):
            sk.plan(model, 3, **wrong)


def test_explain_takes_one_thread_for_its_algebra() -> None:
    """Handing small matrices to threads trebled the time; what the caller had set stands again."""
    from threadpoolctl import threadpool_info, threadpool_limits

    def threads() -> set[int]:
        return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}

    model = sk.base_model(sk.load_robot("ur5e"))
    data = sk.simulate(model, sk.plan(model, 6, force=50.0), seed=1).measurements
    seen: list[set[int]] = []
    with threadpool_limits(limits=2, user_api="blas"):
        sk.explain(model, data, progress=lambda *step: seen.append(threads()))
        assert threads() == {2}
    assert seen
    assert all(each == {1} for each in seen)
