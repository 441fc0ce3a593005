"""Masses that words state and that need not have hung on the tool: what a robot may bear, what was
taken off, what weighs something else.

Where in doubt, a mass counts as such: a load that is taken for none shows, and is easily told.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

DENIED = "something is said to be without it"
RATED = "that may be what a robot bears, or what was set, or taken off"
TYPE = "a robot's type stands before it, whose payload it may be"
OTHER = "that may be the mass of something else"
SHEET = "beside a robot's type or reach it may be what the robot bears"
GRAMS = "grams count behind a word such as payload alone"

_NUMBER = r"\d+(?:[.,p]\d+)?"
_NO = "without|no|not|non|ohne|kein(?:e|en)?|sans|senza|zonder|wo|sin carga"  # as far as the mass
_NO_BESIDE = "sin|minus|less"  # directly before it: a sine, a negative angle
_WITH = "with|mit|avec|con"  # ends what a word before denied
_DENYING = re.compile(
    rf"(?<![^\W\d_])(?:(?!no\W*_?\d)(?:{_NO})(?![^\W\d_])|(?:{_NO_BESIDE})[\W_]*$)", re.IGNORECASE
)  # no_3 is a number
_ENDS = re.compile(rf"(?<![^\W\d_])(?:{_WITH})(?![^\W\d_])", re.IGNORECASE)
_RATED = (
    r"max(?:imum|imal\w*)?|rated|rating|nominal|nenn\w*|capacity|capable|permiss\w*|allow\w*|"
    r"zul(?:ä|ae)ss\w*|class|klasse|classe|reach|reichweite|removed|demounted|dismounted|detached|"
    r"abgenommen|entfernt|abgeh(?:ä|ae)ngt|configured|konfiguriert|eingestellt|traglast|limit"
)
_BODIES = (
    r"counter[\W_]?(?:weight|balance)|gegengewicht|contrepoids|tare|tara|crane|kran|hoist|"
    r"gripper|greifer|base|stand|table|tisch|tripod|pedestal|frame|cell|sensor|smr|reflector|"
    r"probe|camera|tracker|agv|forklift|pallet|link"
)
_RATED_IN_NAME = re.compile(rf"(?<![^\W\d_])(?:{_RATED})(?![^\W\d_])", re.IGNORECASE)
_OFF_BEHIND = re.compile(r"[\W_]*(?:taken[\W_]*)?off(?![^\W\d_])", re.IGNORECASE)
_OFF_BEFORE = re.compile(r"(?<![^\W\d_])off[\W_]*$", re.IGNORECASE)
_BODY_BEFORE = re.compile(rf"(?<![^\W\d_])(?:{_BODIES})[\W_]*$", re.IGNORECASE)
_BODY_ANYWHERE = re.compile(
    r"(?<![^\W\d_])(?:counter[\W_]?(?:weight|balance)|gegengewicht|contrepoids|tare|tara)"
    r"(?![^\W\d_])",
    re.IGNORECASE,
)

# Words that series of robots are called by, as far as they are no other words.
_SERIES = (
    r"kr|irb|ur|sk|lbr|iiwa|lr|crx|tx|rx|gp|mh|staubli|st(?:ä|ae)ubli|kuka|abb|fanuc|yaskawa|"
    r"motoman|comau|nachi|denso|kawasaki|doosan|franka|robot|roboter|robotarm|cobot|manipulator"
)
_SHORT = 3  # letters: words of that length are series before a number alone
# Before digits these count something: run3, scan12.
COUNTING = (
    "poses?|points?|pts?|pt|p|pos(?:ition)?|runs?|rep(?:eat)?|trial|test|file|set|no|nr|stellung|"
    "messung|punkt|wdh|day|config(?:uration)?|meas(?:urement)?|series|station|step"
)
_COUNTING_TOO = (
    f"{COUNTING}|scan|sweep|cycle|try|part|pass|level|grid|batch|log|data|session|take|round|loop|"
    "week|cal(?:ib)?|rev|ver|version|exp|sample|tag|serie|lauf|datei|loads?|payload|weight|mass|"
    "jan|feb|mar|apr|may|jun|jul|aug|sep|oct|nov|dec|row|marker|tool|flange|frame|base|link|joint|axis|target|mess|versuch"
)
_GLUED = re.compile(  # UR10e, KR210_2700, R2000iC
    r"(?<![^\W_])(?P<letters>[^\W\d_]{2,8}|[^\W\d_](?=\d\d))(?P<digits>\d{1,4})[^\W\d_]{0,3}"
    r"(?:[\W_]+\d{1,4})*[\W_]*$"
)
_APART = re.compile(rf"(?<![^\W_])(?:{_SERIES})[\W_]*(?P<digits>\d{{1,4}})?[\W_]*$", re.IGNORECASE)
_M = re.compile(r"(?<![^\W_])M[ _-]?$")  # M-20: m is a mass

# Of a line above a table.
_RATED_IN_LINE = re.compile(
    r"max|rated|rating|nominal|capacit|capable|permiss|allow|limit|nenn|zul(?:ä|ae)ss|traglast|"
    r"up to|bis zu|cell|sensor|smr|reflector|density|dichte|"
    r"(?:robot|arm|link)\W*s? (?:mass|weight)|"
    r"(?:mass|weight) of (?:the |each )?(?:robot|arm|link)",
    re.IGNORECASE,
)
_OFF_IN_LINE = re.compile(
    rf"(?<![^\W\d_])(?:{_RATED}|controller|set (?:in|on|at|to)|counter\W?(?:weight|balance)|"
    r"gegengewicht|contrepoids|tare|tara|crane|kran|gripper|greifer|stand|tripod|pedestal|"
    r"on (?:the )?(?:floor|ground|bench|table))(?![^\W\d_])",
    re.IGNORECASE,
)
_GONE = re.compile(  # wherever in the line
    r"(?<![^\W\d_])(?:off|removed|demounted|dismounted|detached|unmounted|abgenommen|entfernt|"
    r"abgeh(?:ä|ae)ngt|not (?:mounted|hung|attached))(?![^\W\d_])",
    re.IGNORECASE,
)
_TYPE_IN_LINE = re.compile(  # UR10e, KR 16, robot
    rf"(?<![^\W_])(?:(?P<series>{_SERIES})(?P<number>[ -]?\d)?|"
    r"(?P<letters>[^\W\d_]{2,8})-?\d{1,4}[^\W\d_]{0,3}(?![^\W_]))",
    re.IGNORECASE,
)
_INSTRUMENTS = re.compile(r"(?:at|ats|ltd|lt|vp)", re.IGNORECASE)  # AT960, LTD500: trackers
_REACH = re.compile(r"(?<![^\W\d_])(?:reach|reichweite|port(?:é|e)e|dof)(?![^\W\d_])", re.I)


def why_not_in_name(
    stem: str, start: int, end: int, beside: Sequence[str], *, called: bool
) -> str | None:
    """Why the mass at ``stem[start:end]`` may not have hung on the tool; None where it did.

    Args:
        stem: Name of a file without its ending.
        start, end: Where number and unit stand.
        beside: Such names of all files: masses or types that differ among them are no robot's.
        called: Does a word such as *payload* stand directly before it, or behind?
    """
    before, behind = stem[:start], stem[end:]
    if denied(before):
        return DENIED
    off = _OFF_BEHIND.match(behind) or _OFF_BEFORE.search(before)
    if _RATED_IN_NAME.search(stem) or off:
        return RATED
    if _BODY_ANYWHERE.search(stem) or _BODY_BEFORE.search(before):
        return OTHER
    robots = _M.search(before) or (not called and _type_before(before, beside))
    return TYPE if robots and not _varies(before, stem[start:end], beside) else None


def why_not_in_line(text: str, start: int, end: int) -> str | None:
    """The same of a line above a table that states a mass at ``text[start:end]``."""
    before = re.split(r"[,;|]", text[:start])[-1]
    clause = before + text[start:end] + re.split(r"[,;|]", text[end:])[0]
    if denied(before):
        return DENIED
    if _GONE.search(text) or _RATED_IN_LINE.search(clause) or _OFF_IN_LINE.search(clause):
        return RATED
    typed = any(map(_is_type, _TYPE_IN_LINE.finditer(text)))
    return SHEET if typed or _REACH.search(text) else None


def _is_type(found: re.Match[str]) -> bool:
    if found["letters"]:
        return not (_counts(found["letters"]) or _INSTRUMENTS.fullmatch(found["letters"]))
    ends = not re.match(r"[^\W\d_]", found.string[found.end() :])
    return bool(found["number"]) or (ends and len(found["series"]) > _SHORT)


def denied(before: str) -> bool:
    """Does what stands before a mass say that there is none of it?"""
    words = _ENDS.split(before)[-1]
    return _DENYING.search(words) is not None


def _type_before(before: str, beside: Sequence[str]) -> bool:
    """Does a robot's type stand directly before? Digits that differ from file to file are none."""
    if _APART.search(before):
        return True
    found = _GLUED.search(before)
    if found is None or _counts(found["letters"]):
        return False
    shape = re.compile(rf"{re.escape(before[: found.start('digits')])}(\d+)")
    return len({m[1] for name in beside if (m := shape.match(name))}) < 2


def _counts(letters: str) -> bool:
    return re.fullmatch(_COUNTING_TOO, letters, re.IGNORECASE) is not None


def _varies(before: str, mass: str, beside: Sequence[str]) -> bool:
    """Do files differ by the number there alone? A robot's own payload is one; 0 kg is nobody's."""
    if re.match(r"[0.,p]+(?![\d.,p])", mass):
        return True
    alike = re.sub(r"\d+", r"\\d+", re.escape(before))  # whatever is counted there
    shape = re.compile(rf"{alike}({_NUMBER})[ _-]?(?:kg|lbs?)", re.IGNORECASE)
    return len({m[1] for name in beside if (m := shape.match(name))}) > 1
