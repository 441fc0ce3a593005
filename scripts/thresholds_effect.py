"""What each number that steers `explain` does to the blind score, halved and doubled.

    python scripts/thresholds_effect.py CASES --out RUNS [--jobs 2] [--places explain] [--blank]

CASES: sealed cases (`python -m tests.hidden.make_cases`). Every case is answered as it is, and it
is noted which functions ran; then each number is changed alone, in the cases in which a function
that reads it ran. A run that was broken off goes on where it was; RUNS is of one state of the
package. Results go to docs/thresholds.csv, and `python scripts/thresholds.py` puts them into the
table. Whole numbers are rounded after halving, and probabilities stay below one. A case whose
answer never comes, or that ends the process, has no points.
"""

from __future__ import annotations

import argparse
import ast
import csv
import hashlib
import importlib.abc
import importlib.machinery
import json
import shutil
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path
from types import CodeType, FrameType, ModuleType

from thresholds import EFFECTS, PLACES, ROOT, Number, effects, numbers, shown

sys.path.insert(0, str(ROOT))
PACKAGE = ROOT / "sk120stiff"
FACTORS = (0.5, 2.0)
LONGEST = 120.0  # s for one command; a changed tolerance may never be met
FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)


class _Changed(importlib.abc.MetaPathFinder):
    """Imports one module with another number in it: so defaults of arguments change too."""

    def __init__(self, module: str, name: str, value: float | tuple[float, ...]) -> None:
        self.module, self.name, self.value = module, name, value

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        """The usual place, read in another way."""
        if fullname != self.module:
            return None
        spec = importlib.machinery.PathFinder.find_spec(fullname, path, target)
        if spec is not None and spec.origin is not None:
            spec.loader = _Rewritten(fullname, spec.origin, self.name, self.value)
        return spec


class _Rewritten(importlib.machinery.SourceFileLoader):
    """A source file in which one number is another."""

    def __init__(
        self, fullname: str, path: str, name: str, value: float | tuple[float, ...]
    ) -> None:
        super().__init__(fullname, path)
        self.number, self.value = name, value

    def get_code(self, fullname: str) -> CodeType:
        """Compiled from its text; what was compiled before has the old number."""
        tree = ast.parse(self.get_data(self.get_filename(fullname)))
        assert sum(self._replaced(node) for node in tree.body) == 1
        return compile(ast.fix_missing_locations(tree), self.path, "exec")

    def _replaced(self, node: ast.stmt) -> bool:
        if not isinstance(node, ast.Assign):
            return False
        target, new = node.targets[0], ast.parse(repr(self.value), mode="eval").body
        if isinstance(target, ast.Name) and target.id == self.number:
            node.value = new
            return True
        if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
            for place, each in enumerate(target.elts):
                if isinstance(each, ast.Name) and each.id == self.number:
                    node.value.elts[place] = new
                    return True
        return False


def serve(changed: Sequence[str]) -> None:
    """Answer cases as `tests.hidden.batch` does, with one number changed, and say what ran."""
    if changed:
        module, name, text = changed
        value = json.loads(text)
        several = tuple(value) if isinstance(value, list) else value
        sys.meta_path.insert(0, _Changed(module, name, several))
    from tests.hidden.batch import once

    ran: set[CodeType] = set()

    def note(frame: FrameType, event: str, argument: object) -> None:
        del argument
        if event == "call":
            ran.add(frame.f_code)

    for line in sys.stdin:
        out, err, *arguments = json.loads(line)
        if not changed:
            ran.clear()
            sys.setprofile(note)
        code = once(out, err, arguments)
        sys.setprofile(None)
        inside = str(PACKAGE) + "/"
        names = sorted(
            {
                f"{each.co_filename.removeprefix(inside)}:{each.co_firstlineno}"
                for each in ran
                if each.co_filename.startswith(inside)
            }
        )
        print(json.dumps([code, 0.0, names]), flush=True)


class _Served:
    """A process that answers cases, one line each; another takes its place where it ends."""

    def __init__(self, command: Sequence[str]) -> None:
        self.command = command
        self.ran: set[str] = set()
        self.process = self._begun()

    def _begun(self) -> subprocess.Popen[str]:
        return subprocess.Popen(
            self.command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=ROOT
        )  # fmt: skip

    def call(self, out: Path, err: Path, arguments: list[str]) -> tuple[int | None, float]:
        """Exit code and seconds; no code where the answer never comes."""
        stdin, stdout = self.process.stdin, self.process.stdout
        assert stdin is not None
        assert stdout is not None
        stdin.write(json.dumps([str(out), str(err), *arguments]) + "\n")
        stdin.flush()
        patience = threading.Timer(LONGEST, self.process.kill)
        patience.start()
        said = stdout.readline()
        patience.cancel()
        if not said:
            self.end()
            self.process = self._begun()
            return None, LONGEST
        code, seconds, ran = json.loads(said)
        self.ran |= set(ran)
        return code, seconds

    def end(self) -> None:
        """Let the process end."""
        with self.process:
            assert self.process.stdin is not None
            self.process.stdin.close()


@cache
def _readers() -> dict[tuple[str, str], frozenset[str]]:
    """Functions that read each number of the package, by file and name, as ``file:first line``.

    What a module reads on its first level (a default, another number), any function of it may use:
    there is no line then.
    """
    trees = {
        file.relative_to(PACKAGE).as_posix(): ast.parse(file.read_text(encoding="utf-8"))
        for file in sorted(PACKAGE.rglob("*.py"))
    }
    own = {(n.file, n.name) for n in numbers()}
    out: dict[tuple[str, str], set[str]] = {each: set() for each in own}
    for file, tree in trees.items():
        names = {name: (file, name) for place, name in own if place == file}
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and node.module is not None:
                for alias in node.names:
                    origin = _origin(trees, node.module, alias.name)
                    if (origin, alias.name) in own:
                        names[alias.asname or alias.name] = (origin, alias.name)
        for name, place in _read(tree, None, names):
            out[names[name]].add(f"{file}:{'' if place is None else place}")
    return {key: frozenset(found) for key, found in out.items()}


def _origin(trees: Mapping[str, ast.Module], module: str, name: str) -> str:
    """The file in which a name is defined that a module or package gives."""
    place = module.removeprefix("sk120stiff.").replace(".", "/")
    package = trees.get(f"{place}/__init__.py")
    if package is None:
        return f"{place}.py"
    for node in package.body:
        if isinstance(node, ast.ImportFrom) and name in {alias.name for alias in node.names}:
            return _origin(trees, str(node.module), name)
    return f"{place}/__init__.py"


def _read(
    node: ast.AST, function: int | None, names: dict[str, tuple[str, str]]
) -> Iterator[tuple[str, int | None]]:
    """Names that are read below a node, with the first line of the function that reads each."""
    if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and node.id in names:
        yield node.id, function
    inner = function
    if isinstance(node, FUNCTIONS):
        decorators = getattr(node, "decorator_list", [])
        inner = min([node.lineno, *(each.lineno for each in decorators)])
        if isinstance(node, ast.Lambda) and function is not None:
            inner = function
    body = getattr(node, "body", [])
    inside = body if isinstance(body, list) else [body]
    for child in ast.iter_child_nodes(node):
        yield from _read(child, inner if child in inside else function, names)


def _state() -> str:
    """A digest of the package."""
    found = hashlib.sha256()
    for file in sorted(PACKAGE.rglob("*.py")):
        found.update(file.read_bytes())
    return found.hexdigest()


class Bench:
    """Sealed cases, answered as they are and with one number changed."""

    def __init__(self, folder: Path, out: Path, jobs: int) -> None:
        self.folder, self.out = folder.resolve(), out.resolve()
        self.out.mkdir(parents=True, exist_ok=True)
        state = self.out / "state.txt"
        if state.exists() and state.read_text("utf-8") != _state():
            raise SystemExit(f"{self.out} holds runs of another state of the package")
        state.write_text(_state(), encoding="utf-8")
        self.cases = sorted(path.name for path in (self.folder / "cases").iterdir())
        parts = [self.cases[k::jobs] for k in range(jobs)]
        with ThreadPoolExecutor(jobs) as pool:
            found = pool.map(lambda k: self.points(f"as-it-is-{k}", (), parts[k]), range(jobs))
        self.plain = {case: said for part in found for case, said in part.items()}

    def points(
        self, label: str, changed: Sequence[str], cases: Sequence[str]
    ) -> dict[str, tuple[float, frozenset[str]]]:
        """Points of each case, and the functions that ran where nothing was changed."""
        from tests.hidden.answers import read_answer
        from tests.hidden.judge import mark
        from tests.hidden.run import answer

        target = self.out / label
        target.mkdir(parents=True, exist_ok=True)
        for part in ("cases", "truth", "sealed"):
            if not (target / part).exists():
                (target / part).symlink_to(self.folder / part)
        note = target / "ran.json"
        known = json.loads(note.read_text("utf-8")) if note.exists() else {}
        if missing := [case for case in cases if case not in known]:
            command = [sys.executable, __file__, "--serve", *changed]
            runner = _Served(command)
            for case in missing:
                runner.ran.clear()
                shutil.rmtree(target / "answers" / case, ignore_errors=True)  # broken off
                answer(target, case, runner)  # type: ignore[arg-type]
                truth = json.loads((target / "truth" / f"{case}.json").read_text("utf-8"))
                share, wrong, _ = mark(truth, read_answer(target / "answers" / case))
                known[case] = [share - wrong, sorted(runner.ran)]
            runner.end()
            note.write_text(json.dumps(known), encoding="utf-8")
        return {case: (known[case][0], frozenset(known[case][1])) for case in cases}

    def touched(self, number: Number) -> list[str]:
        """Cases in which code that reads a number ran."""
        readers = _readers()[number.file, number.name]
        return [
            case
            for case in self.cases
            if any(ran in readers or f"{ran.partition(':')[0]}:" in readers
                   for ran in self.plain[case][1])
        ]  # fmt: skip

    def change(self, number: Number, factor: float, cases: Sequence[str]) -> float:
        """Change of the points, summed over the cases."""
        label = f"{number.file.replace('/', '.')}-{number.name}-{factor:g}"
        first = [number.module, number.name, json.dumps(number.times(factor))]
        found = self.points(label, first, cases)
        return sum(found[case][0] - self.plain[case][0] for case in cases)


def _written(rows: dict[tuple[str, str, str], dict[str, str]]) -> None:
    """The table of effects, in the order of the files."""
    order = {(n.file, n.name, shown(n.value)): k for k, n in enumerate(numbers())}
    with EFFECTS.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(
            file, ["file", "name", "value", "halved", "doubled", "cases"], lineterminator="\n"
        )
        writer.writeheader()
        writer.writerows(rows[key] for key in sorted(rows.keys() & order.keys(), key=order.get))  # type: ignore[arg-type]


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, nargs="?")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--places", nargs="*", default=list(PLACES))
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--blank", action="store_true", help="only what was never tried")
    parser.add_argument("--serve", nargs="*")
    asked = parser.parse_args(arguments)
    if asked.serve is not None:
        serve(asked.serve)
        return 0
    if asked.folder is None or asked.out is None:
        parser.error("give the folder of the cases and --out")
    bench = Bench(asked.folder, asked.out, asked.jobs)
    plain = sum(points for points, _ in bench.plain.values())
    print(f"as it is: {plain:.3f} points of {len(bench.cases)} cases", flush=True)
    rows = effects()

    def tried(number: Number) -> tuple[Number, int, list[str]]:
        cases = bench.touched(number)
        told = [
            f"{bench.change(number, f, cases):+.2f}" if cases and number.times(f) != number.value
            else ""
            for f in FACTORS
        ]  # fmt: skip
        return number, len(cases), told

    wanted = [
        number
        for number in numbers()
        if any(number.file.startswith(place) for place in asked.places)
        and (not asked.only or number.name in asked.only)
        and not (asked.blank and (number.file, number.name, shown(number.value)) in rows)
    ]
    with ThreadPoolExecutor(asked.jobs) as pool:
        for number, count, (half, twice) in pool.map(tried, wanted):
            print(f"{number.name} ({number.file}): {half} {twice} of {count}", flush=True)
            value = shown(number.value)
            rows[number.file, number.name, value] = {
                "file": number.file, "name": number.name, "value": value,
                "halved": half, "doubled": twice, "cases": str(count),
            }  # fmt: skip
            _written(rows)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
