"""Numbers, vectors and names of one element, with the number syntax that exporters really write."""

from __future__ import annotations

import math
import re

import numpy as np
from lxml.etree import _Element as Element

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.robot.rotations import rotation_from_rpy
from sk120stiff.robot.urdf.findings import Notebook, at, shown

_NUMBER = re.compile(r"[+-]?(?:\d{1,400}\.?\d{0,400}|\.\d{1,400})(?:[eE][+-]?\d{1,6})?\Z", re.ASCII)
_NOT_FINITE = re.compile(r"[+-]?(?:inf|infinity|nan)\Z", re.IGNORECASE)
_SMALLEST = 1e-300
LARGEST = 1e15  # of lengths, angles, masses; files state limits of 1e16 where there is none
_MEASURES = (
    "xyz", "rpy", "value", "radius", "length", "size", "scale", "offset",
    "multiplier", "ixx", "iyy", "izz", "ixy", "ixz", "iyz",
)  # fmt: skip
_ZERO_WIDTH = dict.fromkeys(map(ord, "\u200b\u200c\u200d\ufeff"), None)


class Fields:
    """Reads attributes of the children of one link or joint and notes every repair.

    Args:
        notes: Where repairs and refusals go.
        kind, name: The element for messages, e.g. ``joint``, ``elbow``.
    """

    def __init__(self, notes: Notebook, kind: str, name: str) -> None:
        self.notes, self.kind, self.name = notes, kind, name

    def place(self, element: Element) -> str:
        """Line and name for messages."""
        return at(element.sourceline, self.kind, self.name)

    def warn(self, code: str, element: Element, message: str) -> None:
        """Note a repair at an element."""
        self.notes.warn(code, self.place(element), message)

    def number(self, element: Element, attribute: str) -> float | None:
        """A finite number, or None where the attribute is absent or empty.

        Raises:
            InputError: Something else stands there.
        """
        values = self.vector(element, attribute, 1)
        return None if values is None else float(values[0])

    def bound(self, element: Element, attribute: str) -> float | None:
        """Like `number`, but whatever is no finite number means None and is noted."""
        text = (element.get(attribute) or "").strip()
        if _NOT_FINITE.match(text):
            self.warn("number_syntax", element, f"{attribute} is {text!r}; taken as absent")
            return None
        try:
            return self.number(element, attribute)
        except InputError as error:  # a limit is no part of the kinematics
            self.warn("number_syntax", element, f"{error.what}; taken as absent")
            return None

    def vector(self, element: Element, attribute: str, size: int = 3) -> Array | None:
        """(size,) finite numbers, or None where the attribute is absent or empty.

        Raises:
            InputError: Another count of numbers, or something that is no number.
        """
        text = element.get(attribute)
        if text is None:
            return None
        if not text.strip():
            self.warn("number_syntax", element, f"{attribute} is empty; taken as absent")
            return None
        values = self._tokens(element, attribute, text, size)
        if len(values) != size:
            self._refuse(element, attribute, text, f"holds {len(values)} numbers, not {size}")
        return np.array(values)

    def _tokens(self, element: Element, attribute: str, text: str, size: int) -> list[float]:
        if len(text) > 2000:
            self._refuse(element, attribute, text, "is too long for a number")
        clean = text.replace("\u2212", "-").translate(_ZERO_WIDTH)
        if clean != text:
            note = f"unusual characters in {attribute} {shown(text)} read as plain ones"
            self.warn("number_syntax", element, note)
        words = clean.split()
        if any("," in word or ";" in word for word in words):
            if (
                len(words) == size
                and all(word.count(",") <= 1 for word in words)
                and not any(
                    word.startswith(",") or word.endswith(",") or ";" in word for word in words
                )
            ):
                words = [word.replace(",", ".") for word in words]
                meaning = "as a decimal comma"
            else:
                words = re.split(r"[\s,;]+", clean.strip(" \t\r\n,;"))
                meaning = "as separators"
            note = f"commas in {attribute} {shown(text)} read {meaning}"
            self.warn("number_syntax", element, note)
        values = []
        for word in words:
            plain = word[:-1] if word[-1:] in "fF" and _NUMBER.match(word[:-1]) else word
            if not _NUMBER.match(plain):
                hint = "is not a number"
                if "$" in word or "pi" in word:
                    hint = "is an expression of xacro, not a number"
                self._refuse(element, attribute, text, hint)
            value = float(plain)
            if abs(value) < _SMALLEST:
                value = 0.0  # C++ parsers choke on denormal numbers
            if not math.isfinite(value) or (abs(value) > LARGEST and attribute in _MEASURES):
                self._refuse(element, attribute, text, "is too large for a number")
            if plain != word:
                note = f"{attribute} {shown(text)}: the 'f' was ignored"
                self.warn("number_syntax", element, note)
            values.append(value)
        return values

    def _refuse(self, element: Element, attribute: str, text: str, why: str) -> None:
        remedy = "Write plain numbers with a decimal point, separated by spaces."
        if "xacro" in why:
            remedy = "Give the .xacro file, or expand it first."
        self.notes.refuse(
            f"<{element.tag} {attribute}={shown(text)}> {why}",
            where=self.place(element),
            remedy=remedy,
        )

    def placement(self, parent: Element) -> Array:
        """(4, 4) placement by the `<origin>` of an element, identity where there is none [m]."""
        T = np.eye(4)
        origin = parent.find("origin")
        if origin is None:
            return T
        if len(parent.findall("origin")) > 1:
            self.warn("duplicate_element", origin, "several <origin>; the first one was used")
        xyz = self.vector(origin, "xyz")
        if xyz is not None:
            T[:3, 3] = xyz
        rpy = self.vector(origin, "rpy")
        quaternion = self.vector(origin, "quat_xyzw", 4)
        if quaternion is not None and np.linalg.norm(quaternion) > 1e-9:
            from scipy.spatial.transform import Rotation  # slow to import, and hardly ever needed

            T[:3, :3] = Rotation.from_quat(quaternion).as_matrix()
        elif rpy is not None:
            T[:3, :3] = rotation_from_rpy(rpy)
        return T
