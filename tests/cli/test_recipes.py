"""The conda recipe and the container file, as far as they can be tried without their tools."""

import json
import re
import shlex
import tomllib

import yaml
from jinja2 import StrictUndefined, Template

from tests.test_project import PROJECT, ROOT


def recipe() -> dict:
    """The recipe as conda-build reads it."""
    text = (ROOT / "recipe" / "meta.yaml").read_text(encoding="utf-8")
    given = {"load_file_data": lambda *_, **__: {"project": PROJECT}, "PYTHON": "python"}
    return yaml.safe_load(Template(text, undefined=StrictUndefined).render(**given))


def test_the_conda_recipe_renders_and_its_tests_pass(run) -> None:
    made = recipe()
    assert made["package"] == {"name": PROJECT["name"], "version": PROJECT["version"]}
    assert made["about"]["license"] == PROJECT["license"]
    assert (ROOT / "recipe" / made["source"]["path"] / made["about"]["license_file"]).is_file()
    scripts = [f"{name} = {target}" for name, target in PROJECT["scripts"].items()]
    assert made["build"]["entry_points"] == scripts
    build = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["build-system"]
    assert set(build["requires"]) <= {
        each.replace(" ", "") for each in made["requirements"]["host"]
    }
    for command in made["test"]["commands"]:
        program, *words = shlex.split(command)
        assert program in PROJECT["scripts"]
        assert run(*words).code == 0, command


def test_the_container_installs_what_exists_and_starts_the_program(run) -> None:
    text = (ROOT / "Containerfile").read_text(encoding="utf-8")
    steps = re.findall(r"^([A-Z]+) (.*)$", text, re.MULTILINE)
    assert steps[0][0] == "FROM"
    (image,) = re.findall(r"python:(3\.\d+)-slim$", steps[0][1])
    assert any(each.endswith(f":: {image}") for each in PROJECT["classifiers"])
    extras = re.search(r"/source\[([\w,]+)\]", text)
    assert extras and set(extras.group(1).split(",")) <= set(PROJECT["optional-dependencies"])
    entry = [json.loads(what) for step, what in steps if step in ("ENTRYPOINT", "CMD")]
    assert [entry[0][0]] == list(PROJECT["scripts"])
    assert run(*entry[0][1:], *entry[1]).code == 0
    for command in re.findall(r" sk120stiff ((?:explain|view) .*)$", text, re.MULTILINE):
        told = run(command.split()[0], "--help").stdout
        assert all(option in told for option in re.findall(r"--[\w-]+", command)), command
    users = [what for step, what in steps if step == "USER"]
    assert users and users[-1] != "root"
    kept_out = (ROOT / ".containerignore").read_text(encoding="utf-8").split()
    assert ".venv" in kept_out
