"""YAML as plain values; whatever is wrong with it is the file's fault, and is said so."""

from __future__ import annotations

import os
from dataclasses import dataclass

import yaml

from sk120stiff.errors import InputError
from sk120stiff.files.reading import read_text

LARGEST = 1_000_000  # values, counted as often as aliases repeat them
DEEPEST = 50
# What PyYAML's own constructors raise for values that do not fit their tag or their looks, such as
# `!!float x` or the date 2001-99-99.
_MISFITS = (ValueError, TypeError, KeyError, AttributeError, IndexError, OverflowError)


@dataclass(frozen=True)
class YamlText:
    """Plain values, and the tree of nodes that knows where they stand."""

    content: object
    node: yaml.Node | None


def read_yaml(path: str | os.PathLike[str]) -> YamlText:
    """Values of a YAML file.

    Raises:
        InputError: As `read_text` and `parse_yaml`.
    """
    return parse_yaml(read_text(path), str(path))


def parse_yaml(text: str, where: str) -> YamlText:
    """Values of YAML text; `where` names it in messages.

    Raises:
        InputError: Not YAML, a value that its tag or its look does not allow, a value within
            itself, or more or deeper values than a file of ours can have.
    """
    try:
        loader = yaml.SafeLoader(text)
        try:
            node = loader.get_single_node()
            if node is None:
                return YamlText(None, None)
            _bounded(node, where)
            return YamlText(_constructed(loader, node, where), node)
        finally:
            loader.dispose()
    except RecursionError as error:
        raise _too_deep(where) from error
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        place = f", line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        reason = str(getattr(error, "problem", None) or error).partition("\n")[0]
        raise InputError(
            f"this is not YAML ({reason})",
            where=f"{where}{place}",
            remedy="Write one 'key: value' per line, text with a colon in quotation marks.",
        ) from error


def _constructed(loader: yaml.SafeLoader, node: yaml.Node, where: str) -> object:
    try:
        return loader.construct_document(node)
    except _MISFITS as error:
        culprit = _culprit(node)
        raise InputError(
            f"the value {culprit.value[:40]!r} cannot be read as {_look(culprit)}",
            where=f"{where}, line {culprit.start_mark.line + 1}",
            remedy="Mend it, or put it in quotation marks if text is meant.",
        ) from error


def _culprit(node: yaml.Node) -> yaml.Node:
    """The value that cannot be made; the whole where each alone can."""
    for each in _scalars(node):
        try:
            yaml.SafeLoader("").construct_document(each)
        except (*_MISFITS, yaml.YAMLError):
            return each
    return yaml.ScalarNode(node.tag, "", node.start_mark)


def _scalars(node: yaml.Node) -> list[yaml.ScalarNode]:
    if isinstance(node, yaml.ScalarNode):
        return [node]
    parts = node.value if isinstance(node, yaml.SequenceNode) else sum(node.value, ())
    return [scalar for part in parts for scalar in _scalars(part)]


def _look(node: yaml.Node) -> str:
    kind = str(node.tag).rpartition(":")[2]
    return {"timestamp": "a date", "float": "a number", "int": "a number"}.get(kind, f"a {kind}")


def _bounded(root: yaml.Node, where: str) -> None:
    """Refuse what grows without bound when it is followed: cycles, depth, aliases of aliases."""
    sizes: dict[int, int] = {}
    open_: set[int] = set()

    def size(node: yaml.Node, depth: int) -> int:
        if id(node) in sizes:
            return sizes[id(node)]
        if id(node) in open_:
            raise InputError(
                "a value contains itself",
                where=f"{where}, line {node.start_mark.line + 1}",
                remedy="Write the value out instead of referring to it by *.",
            )
        if depth > DEEPEST:
            raise _too_deep(where)
        open_.add(id(node))
        count = 1
        if isinstance(node, yaml.SequenceNode):
            count += sum(size(part, depth + 1) for part in node.value)
        elif isinstance(node, yaml.MappingNode):
            count += sum(size(part, depth + 1) for pair in node.value for part in pair)
        open_.remove(id(node))
        sizes[id(node)] = count
        return count

    if size(root, 0) > LARGEST:
        raise InputError(
            f"the file unfolds to more than {LARGEST} values",
            where=where,
            remedy="Write values out instead of referring to them by *.",
        )


def _too_deep(where: str) -> InputError:
    return InputError(
        "the file is nested too deeply",
        where=where,
        remedy=f"No file of this toolkit has more than {DEEPEST} levels.",
    )
