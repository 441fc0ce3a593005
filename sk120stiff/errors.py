"""What the toolkit says when it cannot go on.

Two kinds are told apart everywhere: the caller gave something unusable (`InputError`, exit code 2),
or the work was done and its honest answer is "no" (`Refusal`, exit code 1).
"""

from __future__ import annotations

import importlib.util
import math
import warnings
from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from typing import ClassVar, Final


class ToolkitError(Exception):
    """One message in three parts: what is wrong, where, and what to do about it.

    Args:
        what: The finding, without a final full stop.
        where: File, line, column, joint or frame that it was found at.
        remedy: What the reader can do.

    Examples:
        >>> import sk120stiff as sk
        >>> issubclass(sk.InputError, sk.ToolkitError), issubclass(sk.Refusal, sk.ToolkitError)
        (True, True)
    """

    exit_code: ClassVar[int] = 1
    kind: ClassVar[str] = "refusal"

    def __init__(self, what: str, *, where: str | None = None, remedy: str | None = None) -> None:
        self.what = what.rstrip(".")
        self.where = where
        self.remedy = remedy
        super().__init__(str(self))

    def __str__(self) -> str:
        place = f"{self.where}: " if self.where else ""
        remedy = f" {self.remedy}" if self.remedy else ""
        return f"{place}{self.what}.{remedy}"


class InputError(ToolkitError):
    """A file, an option or an argument that cannot be used as given.

    Examples:
        >>> import sk120stiff as sk
        >>> try:
        ...     sk.load_robot("motoman_sk12")
        ... except sk.InputError as error:
        ...     print(error.exit_code, "motoman_sk120" in str(error))
        2 True
    """

    exit_code = 2
    kind = "input"


class Refusal(ToolkitError):
    """The input was fine and the work was done, but there is no honest result to hand out.

    Examples:
        >>> import sk120stiff as sk
        >>> arm = sk.joint_spring_model(sk.load_robot("motoman_sk120"), [1e3] * 6)  # N·m/rad
        >>> try:
        ...     arm.deflect([0.0] * 6, [0, 0, -1e6, 0, 0, 0])
        ... except sk.Refusal as refusal:
        ...     print(refusal.exit_code)
        1
    """

    exit_code = 1


class MissingPart(InputError):
    """An optional part of the toolkit is not installed; the remedy is the install command."""

    def __init__(self, library: str, *, needed_for: str) -> None:
        super().__init__(
            f"{needed_for} needs the library {library!r}, which is not installed",
            remedy=f'Install it with: pip install "sk120stiff[{EXTRA_OF[library]}]"',
        )


#: Library that the plain install lacks → the extra of the package that brings it.
EXTRA_OF: Final = {
    "distributed": "cluster",
    "matplotlib": "view",
    "meshcat": "view",
    "numba": "map",
    "openpyxl": "import",
    "pandas": "map",
    "rosbags": "import",
    "tornado": "view",
    "trimesh": "view",
    "xacro": "xacro",
    "xarray": "map",
    "yourdfpy": "view",
    "zarr": "map",
}


def require(library: str, *, needed_for: str) -> None:
    """Stop where a library that the plain install lacks is about to be used and is not there.

    Raises:
        MissingPart: It is not installed.
    """
    if importlib.util.find_spec(library) is None:
        raise MissingPart(library, needed_for=needed_for)


class ToolkitWarning(UserWarning):
    """Something suspicious that does not stop the work.

    Examples:
        >>> import sk120stiff as sk
        >>> import warnings
        >>> with warnings.catch_warnings(record=True) as said:
        ...     warnings.simplefilter("always", sk.ToolkitWarning)
        ...     torques = sk.load_robot("motoman_sk120").gravity_torque([0.0] * 6)
        >>> print(said[0].message)
        motoman_sk120 states no masses: its gravity torques are all zero
    """


def warn(text: str, *, stacklevel: int = 2) -> None:
    """A `ToolkitWarning` that points at the caller's caller, or as many calls up as is said."""
    warnings.warn(text, ToolkitWarning, stacklevel=stacklevel + 1)


def two_digits(value: float) -> str:
    """Two significant digits; from 100 to 100 000 all before the point, and no power of ten.

    >>> two_digits(0.01234), two_digits(9.96), two_digits(103.4), two_digits(1.23e6)
    ('0.012', '10', '103', '1.2e+06')
    """
    return f"{value:.0f}" if 99.5 <= abs(value) < 1e5 else f"{value:.2g}"


def micro(value: float, digits: int = 3) -> str:
    """Millionths, as µm of metres: so many significant digits, all that stand before the point.

    >>> micro(2e-5), micro(1.2345e-4), micro(1.7712e-3), micro(1.7124e-2, 4)
    ('20.0', '123', '1771', '17124')
    """
    millionths = 1e6 * value
    large = abs(millionths) >= 10 ** (digits - 1) - 0.05
    return f"{millionths:.0f}" if large else f"{millionths:#.{digits}g}"


def short(value: float, digits: int = 3) -> str:
    """So many significant digits, without powers of ten and without zeros at the end.

    >>> short(1771.2), short(30.0), short(0.012345), short(2.5e6)
    ('1770', '30', '0.0123', '2500000')
    """
    return f"{float(f'{value:.{digits}g}'):.15g}"


def to_one_place(error: float | None, *values: float) -> list[str]:
    """Values, and last their standard error, all to the decimal place of its second digit.

    Without an error, five significant digits each. What is infinite stays so.

    >>> to_one_place(0.007945, -3842.412345)
    ['-3842.4123', '0.0079']
    >>> to_one_place(12637.0, 1.4973e6), to_one_place(2.5e-7, 1.2345e-5)
    (['1497000', '13000'], ['1.234e-05', '0.025e-05'])
    """
    finite = [abs(value) for value in values if math.isfinite(value)]
    if error is None or not math.isfinite(error) or error <= 1e-12 * max(finite, default=0.0):
        return [f"{value + 0.0:.5g}" for value in (*values, *(() if error is None else (error,)))]
    place = math.floor(math.log10(float(f"{error:.1e}"))) - 1  # 0.0996 is 0.10
    first = math.floor(math.log10(max(finite + [error])))
    plain = -5 < first < 8
    power = 0 if plain else first
    digits = max(0, power - place)

    def said(value: float) -> str:
        if not math.isfinite(value):
            return f"{value:g}"
        text = f"{round(value / 10.0**power, power - place) + 0.0:.{digits}f}"
        return text if plain or float(text) == 0.0 else f"{text}e{power:+03d}"

    return [said(value) for value in (*values, error)]


def listed(words: Sequence[str], joint: str = "and", most: int | None = None) -> str:
    """``a, b and c``: names in a sentence; of more than `most` the first, ``a, b and 3 more``."""
    if most is not None and len(words) > most:
        words = [*words[:most], f"{len(words) - most} more"]
    if len(words) < 2:
        return "".join(words)
    return f"{', '.join(words[:-1])} {joint} {words[-1]}"


def meant(name: str, known: Iterable[str]) -> str:
    """`` (did you mean 'other'?)`` behind a name that is unknown; nothing where none is near."""
    close = get_close_matches(name, known, n=1)
    return f" (did you mean {close[0]!r}?)" if close else ""
