"""Every number that steers `explain`: its reason, and what it does to the blind score.

    python scripts/thresholds.py --table                    # docs/THRESHOLDS.md, from the files
    python scripts/thresholds.py --folder CASES --out RUNS  # the score at half, once and twice
    python scripts/thresholds.py --folder CASES --out RUNS --only MARGIN DIFFER

CASES: sealed cases (`python -m tests.hidden.make_cases`). A run that was broken off goes on where
it was; what is done is printed at once. Whole numbers are rounded after halving, and probabilities
stay below one.
"""

from __future__ import annotations

import argparse
import ast
import importlib
import json
import subprocess
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

PLACES = ("explain", "identify", "data_checks", "pilot")
HEAD = """# The numbers that steer `explain`

Module-level numbers of the data checks, the fit, the search, the judgement and the pilot, each with
the reason that stands beside it in its file. Made by `python scripts/thresholds.py --table`;
`--folder` prints how the blind score changes when each single number is halved and doubled.

| name | value | file | what it is |
|---|---|---|---|
"""


ARITHMETIC = (ast.Constant, ast.UnaryOp, ast.BinOp, ast.operator, ast.unaryop)


@dataclass(frozen=True)
class Number:
    """One number, where it stands, and why."""

    name: str
    value: float | tuple[float, ...]
    file: str
    reason: str

    @property
    def module(self) -> str:
        """Where it is defined."""
        return "sk120stiff." + self.file.removesuffix(".py").replace("/", ".")

    def times(self, factor: float) -> float:
        """The number at another size, of the same kind."""
        assert not isinstance(self.value, tuple)
        if isinstance(self.value, int):
            return max(round(self.value * factor), 1)
        moved = self.value * factor
        return min(moved, 0.5 * (1.0 + self.value)) if self.value < 1.0 else moved


def numbers() -> list[Number]:
    """All numbers of `PLACES`, in the order of their files."""
    files = [f for place in PLACES for f in sorted((ROOT / "sk120stiff" / place).rglob("*.py"))]
    return [number for file in files for number in _of(file)]


def _of(file: Path) -> Iterator[Number]:
    lines = file.read_text(encoding="utf-8").splitlines()
    for node, name, value in _constants(ast.parse("\n".join(lines))):
        above = []
        for line in reversed(lines[: node.lineno - 1]):
            if not line.startswith(("# ", "#: ")):
                break
            above.insert(0, line.partition(" ")[2])
        beside = [
            line.partition("#")[2].strip() for line in lines[node.lineno - 1 : node.end_lineno]
        ]
        inside = file.relative_to(ROOT / "sk120stiff").as_posix()
        yield Number(name, value, inside, " ".join([*above, *beside]).strip())


def _constants(module: ast.Module) -> Iterator[tuple[ast.Assign, str, float | tuple[float, ...]]]:
    for node in module.body:
        if not isinstance(node, ast.Assign):
            continue
        target, value = node.targets[0], node.value
        pairs: Iterable[tuple[ast.expr, ast.expr]] = [(target, value)]
        if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
            pairs = zip(target.elts, value.elts, strict=True)
        for each, stands in pairs:
            if isinstance(each, ast.Name) and each.id.isupper():
                number = _value(stands)
                if number is not None:
                    yield node, each.id, number


def _value(node: ast.expr) -> float | tuple[float, ...] | None:
    """The number or numbers that stand there, sums and products worked out; None: no numbers."""
    if isinstance(node, ast.Tuple):
        values = [_value(each) for each in node.elts]
        single = tuple(x for x in values if isinstance(x, (int, float)))
        return single if values and len(single) == len(values) else None
    if any(not isinstance(n, ARITHMETIC) for n in ast.walk(node)):
        return None
    value = eval(compile(ast.Expression(node), "", "eval"))  # numbers and + - * / ** alone
    return value if type(value) in (int, float) else None


def table() -> str:
    """The table as Markdown."""
    rows = [f"| {n.name} | {_shown(n.value)} | {n.file} | {n.reason} |\n" for n in numbers()]
    return HEAD + "".join(rows)


def _shown(value: float | tuple[float, ...]) -> str:
    return ", ".join(f"{x:.10g}" for x in (value if isinstance(value, tuple) else (value,)))


def serve(module: str, name: str, value: float) -> None:
    """Answer cases as `tests.hidden.batch` does, with one number changed wherever it is used."""
    importlib.import_module("sk120stiff.cli.main")
    owner = importlib.import_module(module)
    before = getattr(owner, name)
    kind = type(before)
    for used in [m for k, m in sys.modules.items() if k.startswith("sk120stiff") and m]:
        if used is owner or (getattr(used, name, None) is before and _imports(used, module, name)):
            setattr(used, name, kind(value))
    from tests.hidden.batch import once

    for line in sys.stdin:
        out, err, *arguments = json.loads(line)
        print(json.dumps([once(out, err, arguments), 0.0]), flush=True)


def _imports(used: object, module: str, name: str) -> bool:
    """Does a module take the number from its owner?"""
    source = Path(str(getattr(used, "__file__", ""))).read_text(encoding="utf-8")
    return any(
        isinstance(node, ast.ImportFrom)
        and node.module == module
        and name in {alias.name for alias in node.names}
        for node in ast.walk(ast.parse(source))
    )


def points(folder: Path, out: Path, number: Number | None, factor: float) -> float:
    """Mean points over the cases, with one number changed; answers are kept in `out`."""
    from tests.hidden.answers import read_answer
    from tests.hidden.judge import mark
    from tests.hidden.run import ENVIRONMENT, answer

    label = f"{number.file.replace('/', '.')}-{number.name}-{factor:g}" if number else "as-it-is"
    target = out / label
    target.mkdir(parents=True, exist_ok=True)
    for part in ("cases", "truth", "sealed"):
        if not (target / part).exists():
            (target / part).symlink_to((folder / part).resolve())
    first = [number.module, number.name, str(number.times(factor))] if number else []
    command = [sys.executable, __file__, "--serve", *first]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=ROOT, env=ENVIRONMENT
    ) as process:
        runner = _Served(process)
        total = []
        for case in sorted((target / "cases").iterdir()):
            answer(target, case.name, runner)
            truth = json.loads((target / "truth" / f"{case.name}.json").read_text("utf-8"))
            share, wrong, _ = mark(truth, read_answer(target / "answers" / case.name))
            total.append(share - wrong)
        process.stdin.close()  # type: ignore[union-attr]
    return sum(total) / len(total)


class _Served:
    """A process that answers cases, one line each."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self.process = process

    def call(self, out: Path, err: Path, arguments: list[str]) -> tuple[int | None, float]:
        """Exit code and seconds."""
        stdin, stdout = self.process.stdin, self.process.stdout
        assert stdin is not None
        assert stdout is not None
        stdin.write(json.dumps([str(out), str(err), *arguments]) + "\n")
        stdin.flush()
        code, seconds = json.loads(stdout.readline())
        return code, seconds


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--table", action="store_true")
    parser.add_argument("--folder", type=Path)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--serve", nargs="*")
    asked = parser.parse_args(arguments)
    if asked.serve is not None:
        if asked.serve:
            serve(asked.serve[0], asked.serve[1], float(asked.serve[2]))
        else:
            serve("sk120stiff.explain.options", "MOST_EFFECTS", 8)
        return 0
    if asked.table:
        (ROOT / "docs" / "THRESHOLDS.md").write_text(table(), encoding="utf-8")
        return 0
    if asked.folder is None or asked.out is None:
        parser.error("give --table, or --folder and --out")
    plain = points(asked.folder, asked.out, None, 1.0)
    print(f"as it is: {plain:+.3f} points a case", flush=True)
    for number in numbers():
        if isinstance(number.value, tuple) or (asked.only and number.name not in asked.only):
            continue
        half, twice = (points(asked.folder, asked.out, number, f) - plain for f in (0.5, 2.0))
        print(
            f"{number.name} ({number.file}): halved {half:+.3f}, doubled {twice:+.3f}", flush=True
        )
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
