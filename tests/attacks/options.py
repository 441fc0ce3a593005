"""Attacks through the command line itself: every option of every command with values from hell."""

from __future__ import annotations

import os
import random
from collections.abc import Iterator
from pathlib import Path

from tests.attacks.inputs import desk
from tests.attacks.judge import Verdict, here

VALUES = (
    "-1", "0", "-0", "nan", "inf", "-inf", "1e308", "-1e308", "1e-308", "1e400", "9" * 30, "x", "",
    " ", "\x1b[31m", "\x00", "..", "no/such/place", "/dev/zero", "/dev/full", "=1+1", "1,2,3",
    "1,2,3 furlong", "nan,nan,nan N", "1e308,0,0 N", "1e400,0,0 N", "0,0,-1e15 N", "a=b",
    "joint_2_l=1e9 deg", "joint_2_l=nan deg", "joint_2_l=::1e-9 deg", "joint_2_l=0:9:0 deg",
    "x=0:1:-1; y=0; z=0 m", "x=0;y=0;z=0 m", "😀", "-", "--", "tool0", "base_link",
    "joint_springs", "base_rocking", "base_rocking,base_sliding", ",", "=", "[]", "{}", "0x10",
    "½", "1_0", "a" * 5000,
)  # fmt: skip
PLAIN = {  # a command line that works, to which one option is added
    "check": "rob",
    "new": "rob --out made",
    "stiffness": "rob --wrench 0,0,-100N",
    "identify": "m.csv",
    "predict": "mod.yaml m.csv",
    "explain": "m.csv --no-report --out e",
    "effects": "",
    "plan": "--model mod.yaml --count 2",
    "simulate": "mod.yaml m.csv --out s.csv",
    "import": "m.csv --robot rob --out i.csv",
    "compensate": "mod.yaml path.csv --out c.csv",
    "export": "mod.yaml --out x.xml",
    "posture": "mod.yaml place.csv --out b.csv",
    "map": "rob --grid joint_2_l=0:9:3deg --out m.zarr",
    "view": "rob --static v.html",
}


def options_of(command: str) -> list[str]:
    """Long names of a command's options that take a value."""
    from sk120stiff.cli.main import _load

    return [
        next(name for name in found.opts if name.startswith("--"))
        for found in _load(command).params
        if found.param_type_name == "option" and not getattr(found, "is_flag", False)
    ]


def all_options() -> list[tuple[str, str]]:
    """Every command and option that is attacked."""
    return [(command, option) for command in PLAIN for option in options_of(command)]


def options(folder: Path, count: int = 400, seed: int = 0) -> Iterator[Verdict]:
    """Values for options, drawn by the seed; every option has its turn before one has two."""
    place = folder / "a" / "b"
    desk(place)
    draw = random.Random(seed)
    pairs = all_options()
    home = Path.cwd()
    os.chdir(place)
    try:
        for k in range(count):
            if k % len(pairs) == 0:
                draw.shuffle(pairs)
            command, option = pairs[k % len(pairs)]
            value = draw.choice(VALUES)
            words = [command, *PLAIN[command].split(), option, value]
            yield here(f"option {k}: {' '.join(words)[:150]!r}", *words)
    finally:
        os.chdir(home)
