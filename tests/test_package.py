"""What an installed copy carries, and what importing it costs."""

import ast
import importlib
import re
import subprocess
import sys
import tomllib
import zipfile
from collections.abc import Iterable
from importlib.metadata import requires
from pathlib import Path

import pytest

import sk120stiff
from sk120stiff.errors import EXTRA_OF
from sk120stiff.robot.bundled import bundled_robots

ROOT = Path(__file__).resolve().parent.parent


def test_every_public_name_is_there() -> None:
    assert sorted(sk120stiff.__all__) == sorted(sk120stiff._HOME)
    for name in set(sk120stiff.__all__) - {"CATALOGUE"}:  # a value has no name of its own
        called = sk120stiff._CALLED_THERE.get(name, name)
        assert getattr(sk120stiff, name).__name__ == called
    assert set(sk120stiff.__all__) < set(dir(sk120stiff))
    folders = {path.parent.name for path in ROOT.glob("sk120stiff/*/__init__.py")}
    held = {name for name in vars(type(sk120stiff)) if not name.startswith("_")}
    assert folders & set(sk120stiff.__all__) == held  # a folder would hide any other name


def test_type_checkers_see_the_same_names() -> None:
    tree = ast.parse(Path(sk120stiff.__file__).read_text(encoding="utf-8"))
    imported = {
        alias.asname or alias.name: node.module
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("sk120stiff")
        for alias in node.names
    }
    assert imported.pop("show") == "sk120stiff"  # the one folder among them
    assert imported == sk120stiff._HOME
    assert sk120stiff.show is sys.modules["sk120stiff.show"]


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="load_robots"):
        _ = sk120stiff.load_robots


def test_importing_the_package_imports_nothing_else() -> None:
    code = (
        "import sys; before = set(sys.modules)\n"
        "import sk120stiff; print(*set(sys.modules) - before)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    outside = {name.partition(".")[0] for name in done.stdout.split()} - {"sk120stiff"}
    assert outside <= set(sys.stdlib_module_names)
    assert "sk120stiff.errors" not in done.stdout.split()


def test_the_checkout_finds_its_robots() -> None:
    assert bundled_robots()["motoman_sk120"] == ROOT / "robots" / "motoman_sk120"


# import → package; Pinocchio brings its collision library, which had another name before
OTHER_NAMES = {"pinocchio": "pin", "coal": "pin", "hppfcl": "pin", "yaml": "pyyaml"}
# Not imported here, but without it a library of ours cannot do what we ask of it.
THROUGH = {"pycollada": "trimesh"}


def names(entries: Iterable[str]) -> set[str]:
    return {re.split(r"[ \[<>=!;]", entry)[0].lower() for entry in entries}


def libraries_in(folder: str) -> dict[str, Path]:
    """Libraries that the code imports or looks for at any level of a file, each with a file."""
    found: dict[str, Path] = {}
    for path in (ROOT / folder).rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            modules = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom) and not node.level:
                modules = [node.module or ""]
            if isinstance(node, ast.Call) and ast.unparse(node.func) in ("find_spec", "require"):
                modules = [a.value for a in node.args if isinstance(a, ast.Constant)]
            found |= {module.partition(".")[0]: path for module in modules}
    known = {*sys.stdlib_module_names, "sk120stiff"}
    return {top: path for top, path in found.items() if top not in known}


def test_libraries_that_are_imported_are_those_that_are_declared() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    named = names(project["dependencies"])
    extras = {extra: names(entries) for extra, entries in project["optional-dependencies"].items()}
    imported = libraries_in("sk120stiff")
    for top, path in imported.items():
        where = extras[EXTRA_OF[top]] if top in EXTRA_OF else named
        assert OTHER_NAMES.get(top, top) in where, f"{path} imports {top}"
    for library, user in THROUGH.items():
        assert user in imported and library in names(requires(user) or ())
    used = {EXTRA_OF[top] for top in imported if top in EXTRA_OF}
    declared = named.union(*(extras[extra] for extra in used)) - {"sk120stiff"}
    assert declared == {OTHER_NAMES.get(top, top) for top in imported} | set(THROUGH)


@pytest.fixture(scope="session")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel that `pip install .` would install, built without any network."""
    from hatchling.builders.wheel import WheelBuilder

    folder = tmp_path_factory.mktemp("wheel")
    return Path(next(WheelBuilder(str(ROOT)).build(directory=str(folder), versions=["standard"])))


def test_the_wheel_carries_robots_and_types(wheel: Path) -> None:
    names = set(zipfile.ZipFile(wheel).namelist())
    robots = ROOT / "robots"
    for path in robots.rglob("*"):
        if path.is_file() and "__pycache__" not in path.parts:
            assert f"sk120stiff/_robots/{path.relative_to(robots).as_posix()}" in names
    assert "sk120stiff/py.typed" in names
    assert {name.partition("/")[0] for name in names} == {
        "sk120stiff",
        f"sk120stiff-{sk120stiff.__version__}.dist-info",
    }


def test_the_wheel_works_without_the_checkout(wheel: Path, tmp_path: Path) -> None:
    zipfile.ZipFile(wheel).extractall(tmp_path)
    code = (
        "import sk120stiff\n"
        "from sk120stiff.robot.bundled import bundled_robots\n"
        "print(sk120stiff.__file__)\n"
        "print(bundled_robots()['motoman_sk120'])\n"
        "print(sk120stiff.load_robot('motoman_sk120').n)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path,
        env={"PYTHONPATH": str(tmp_path), "PATH": ""},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == [
        str(tmp_path / "sk120stiff" / "__init__.py"),
        str(tmp_path / "sk120stiff" / "_robots" / "motoman_sk120"),
        "6",
    ]


@pytest.mark.parametrize("folder", ["scripts", "docs"])
def test_what_scripts_and_pages_import_is_there(folder: str) -> None:
    missing = []
    for file in (ROOT / folder).rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("sk120stiff"):
                module = importlib.import_module(node.module or "")
                names = [alias.name for alias in node.names]
                beside = Path(module.__file__ or "").parent
                missing += [
                    f"{file.name}: {node.module}.{name}"
                    for name in names
                    if not hasattr(module, name) and not list(beside.glob(f"{name}*"))
                ]
    assert not missing
