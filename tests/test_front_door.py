"""`import sk120stiff as sk`: the names are there whatever was imported before, and examples run."""

from __future__ import annotations

import doctest
import inspect
import subprocess
import sys
from collections.abc import Callable

import pytest

import sk120stiff as sk

VERBS = ("compensate", "explain", "fit", "load_robot", "plan", "predict", "read", "read_model",
         "simulate", "stiffness")  # fmt: skip
EXAMPLES = doctest.DocTestFinder(recurse=False)
WITH_EXAMPLE = ("load_robot", "bundled_robots", "read", "fit", "explain", "plan", "simulate",
                "predict", "stiffness", "compensate", "effect", "Catalogue", "base_model",
                "read_model", "joint_spring_model")  # fmt: skip


@pytest.mark.parametrize("name", WITH_EXAMPLE)
def test_the_example_in_the_docstring_runs(name: str) -> None:
    item = inspect.unwrap(getattr(sk, name))
    (example,) = EXAMPLES.find(item, name, globs={})
    assert example.examples
    said: list[str] = []
    failed = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(
        example, out=said.append
    )
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


@pytest.mark.parametrize("name", ["explain", "plan", "stiffness"])
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
def test_a_folder_never_hides_the_verb_of_its_name(name: str, before: str) -> None:
    code = (
        f"import sk120stiff as sk, sys\n{before.format(name=name)}\n"
        f"from sk120stiff import {name}\n"
        f"assert callable(sk.{name}) and sk.{name} is {name}, sk.{name}\n"
        f"import sk120stiff.{name}\n"
        f"from sk120stiff.{name} import __all__ as inside\n"
        f"assert sk.{name} is {name} and inside\n"
        f"assert sys.modules['sk120stiff.{name}'].__name__ == 'sk120stiff.{name}'\n"
    )
    done = subprocess.run(
        [sys.executable, "-W", "error::ImportWarning", "-c", code], capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="explane"):
        _ = sk.explane
