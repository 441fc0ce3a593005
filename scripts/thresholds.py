"""Every number that steers `explain`: its reason, and what it does to the blind score.

python scripts/thresholds.py                            # docs/THRESHOLDS.md, from the files
python scripts/thresholds_effect.py CASES --out RUNS    # its last columns, see there
"""

from __future__ import annotations

import ast
import csv
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
EFFECTS = ROOT / "docs" / "thresholds.csv"

PLACES = ("explain", "identify", "data_checks", "pilot")
HEAD = """# The numbers that steer `explain`

Module-level numbers of the data checks, the fit, the search, the judgement and the pilot, each with
the reason that stands beside it in its file. Made by `python scripts/thresholds.py`.

*Halved* and *doubled* say by how many points the sum over the cases of a blind benchmark changes
when that number alone is half as large or twice (a right answer brings one point, a wrong name
costs one), over those cases in which code that reads it runs; their number is beside. A number
between a third and one is not doubled, but goes half the way to one. `scripts/thresholds_effect.py`
makes them; of several numbers at once each is changed. Where nothing stands it is no other number
when halved, or no case reaches it. Ten
cases (L0.plans, L1.plans, L3, L4, L6, L7, L9, L10, L11, L12; seed 777003) tried all of them: few
cases show what hangs on a number, not that nothing does. Of no case is what
does not run while readings are explained, as the pilot.

| name | value | file | what it is | halved | doubled | cases |
|---|---|---|---|---|---|---|
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

    def times(self, factor: float) -> float | tuple[float, ...]:
        """The number, or each of several, at another size and of the same kind."""
        if isinstance(self.value, tuple):
            return tuple(_times(each, factor) for each in self.value)
        return _times(self.value, factor)


def _times(value: float, factor: float) -> float:
    if isinstance(value, int):
        return max(round(value * factor), min(value, 1))
    moved = value * factor
    return min(moved, 0.5 * (1.0 + value)) if value < 1.0 else moved


def numbers() -> list[Number]:
    """All numbers of `PLACES`, in the order of their files."""
    files = [f for place in PLACES for f in sorted((ROOT / "sk120stiff" / place).rglob("*.py"))]
    return [number for file in files for number in _of(file)]


def _of(file: Path) -> Iterator[Number]:
    lines = file.read_text(encoding="utf-8").splitlines()
    for node, name, value in _constants(ast.parse("\n".join(lines))):
        above: list[str] = []
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
    found = effects()
    return HEAD + "".join(
        f"| {n.name} | {shown(n.value)} | {n.file} | {n.reason} | {_effect(found, n)} |\n"
        for n in numbers()
    )


def effects() -> dict[tuple[str, str, str], dict[str, str]]:
    """What was measured, by file, name and value of a number."""
    if not EFFECTS.exists():
        return {}
    with EFFECTS.open(encoding="utf-8", newline="") as lines:
        return {(row["file"], row["name"], row["value"]): row for row in csv.DictReader(lines)}


def _effect(found: dict[tuple[str, str, str], dict[str, str]], number: Number) -> str:
    """The last columns; what was measured at another value is of no use."""
    row = found.get((number.file, number.name, shown(number.value)))
    return " | | " if row is None else f"{row['halved']} | {row['doubled']} | {row['cases']}"


def shown(value: float | tuple[float, ...]) -> str:
    """The value or values as the table prints them."""
    return ", ".join(f"{x:.10g}" for x in (value if isinstance(value, tuple) else (value,)))


if __name__ == "__main__":
    (ROOT / "docs" / "THRESHOLDS.md").write_text(table(), encoding="utf-8")
