"""Columns as a controller has them, turned into joints by linear expressions: ``-(J2 + J3)``.

A small parser, no evaluation: sums, products with numbers, quotients by numbers, parentheses, and
constants with a unit (``90 deg``).
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sk120stiff import units
from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.measurements.table.table import Table

_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>[A-Za-z_][\w.]*)"
    r"|(?P<mark>[-+*/()]))"
)
_CONSTANT = ""  # key of the constant term


@dataclass(frozen=True)
class Linear:
    """A linear expression: share of each column, and a constant under the empty name.

    A constant is a bare number until a unit makes it an angle or a length.
    """

    terms: dict[str, float]
    bare: bool = False

    def times(self, factor: float) -> Linear:
        """Everything multiplied."""
        return Linear({name: factor * share for name, share in self.terms.items()}, self.bare)

    def plus(self, other: Linear) -> Linear:
        """The sum of two."""
        names = dict.fromkeys([*self.terms, *other.terms])
        return Linear({n: self.terms.get(n, 0.0) + other.terms.get(n, 0.0) for n in names})


def parse_linear(text: str, where: str) -> Linear:
    """``-(J2 + J3)``, ``J4/101``, ``0.5*J1 + 90 deg``.

    Raises:
        InputError: Something else, with the place in the text.
    """
    return _Parser(text, where).whole()


class _Parser:
    def __init__(self, text: str, where: str) -> None:
        self.text, self.where = text, where
        self.tokens: list[tuple[str, str]] = []
        at = 0
        while text[at:].strip():
            match = _TOKEN.match(text, at)
            if match is None:
                raise self.wrong(f"{text[at:].strip()[0]!r} cannot stand here")
            kind = str(match.lastgroup)
            self.tokens.append((kind, match[kind]))
            at = match.end()
        self.at = 0

    def wrong(self, what: str) -> InputError:
        return InputError(
            f"{self.text!r} is no linear expression: {what}",
            where=self.where,
            remedy="Write sums of columns times or over numbers, like  joint_3: -(J2 + J3)  or  "
            "joint_4: J4/101 + 90 deg.",
        )

    def peek(self) -> str:
        return self.tokens[self.at][1] if self.at < len(self.tokens) else ""

    def take(self) -> tuple[str, str]:
        if self.at >= len(self.tokens):
            raise self.wrong("it ends too early")
        self.at += 1
        return self.tokens[self.at - 1]

    def whole(self) -> Linear:
        found = self.sum()
        if self.peek():
            raise self.wrong(f"{self.peek()!r} cannot stand here")
        if found.bare and found.terms.get(_CONSTANT, 0.0):
            raise self.wrong("a constant needs a unit")
        return found

    def sum(self) -> Linear:
        found = self.product()
        while self.peek() in ("+", "-"):
            sign = -1.0 if self.take()[1] == "-" else 1.0
            other = self.product()
            for side in (found, other):
                if side.bare and side.terms.get(_CONSTANT, 0.0):
                    raise self.wrong("a constant needs a unit, like 90 deg")
            found = found.plus(other.times(sign))
        return found

    def product(self) -> Linear:
        found = self.factor()
        while self.peek() in ("*", "/"):
            mark = self.take()[1]
            other = self.factor()
            if mark == "/":
                if not other.bare or not other.terms[_CONSTANT]:
                    raise self.wrong("it divides by something that is no number but zero")
                found = found.times(1.0 / other.terms[_CONSTANT])
            elif other.bare:
                found = found.times(other.terms[_CONSTANT])
            elif found.bare:
                found = other.times(found.terms[_CONSTANT])
            else:
                raise self.wrong("it multiplies columns with one another")
        return found

    def factor(self) -> Linear:
        kind, text = self.take()
        if text in ("+", "-"):
            return self.factor().times(-1.0 if text == "-" else 1.0)
        if text == "(":
            found = self.sum()
            if self.take()[1] != ")":
                raise self.wrong("a parenthesis stays open")
            return found
        if kind == "number":
            unit = self.tokens[self.at] if self.at < len(self.tokens) else ("", "")
            if unit[0] == "name" and units.is_unit(unit[1]):
                self.at += 1
                family = "angle" if units.is_kind(unit[1], "angle") else "length"
                value = float(units.to_si(float(text), unit[1], family, where=self.where))
                return Linear({_CONSTANT: value})
            return Linear({_CONSTANT: float(text)}, bare=True)
        if kind == "name":
            return Linear({text: 1.0})
        raise self.wrong(f"{text!r} cannot stand here")


def mapped_joints(
    table: Table, kinds: Mapping[str, str], mapping: Mapping[str, str | float], place: str
) -> tuple[dict[str, str], Array, tuple[str, ...]]:
    """Joint names with their kinds, their values (N, n) [rad or m], and columns only used.

    Other columns stay joints of their own name; those that an expression uses only count where the
    robot has such a joint.

    Raises:
        InputError: An expression that is none, or one of a column that does not exist or is of
            another kind.
    """
    values = {name: table.quantity(name, kind) for name, kind in kinds.items()}
    found: dict[str, str] = {}
    used: set[str] = set()
    columns: list[Array] = []
    for joint, text in mapping.items():
        where = f"{place}.{joint}"
        linear = parse_linear(str(text), where)
        names = [name for name in linear.terms if name]
        for name in names:
            if name not in kinds:
                raise InputError(
                    f"no column is called {name!r}",
                    where=where,
                    remedy=f"Columns of angles and lengths are: {', '.join(kinds)}.",
                )
        used |= set(names)
        own = {kinds[name] for name in names} or {"angle"}
        if len(own) > 1:
            raise InputError(f"{text!r} adds angles to lengths", where=where)
        total = np.full(len(table.lines), linear.terms.get(_CONSTANT, 0.0))
        for name in names:
            total += linear.terms[name] * values[name]
        found[joint] = own.pop()
        columns.append(total)
    for name, kind in kinds.items():
        if name not in found:
            found[name] = kind
            columns.append(values[name])
    return found, np.column_stack(columns), tuple(sorted(used - mapping.keys()))
