"""Attacks through input files: mutated readings, settings, models, robots and paths."""

from __future__ import annotations

import random
import shutil
from collections.abc import Iterator
from pathlib import Path

from tests.attacks.files import mutated_csv, mutated_xml, mutated_yaml
from tests.attacks.judge import Verdict, here

SK120 = Path(__file__).resolve().parents[2] / "robots" / "motoman_sk120"
JOINTS = ",".join(f"joint_{k}_{c}[deg]" for k, c in enumerate("slurbt", start=1))
PATH = f"point,{JOINTS},fx[N],fy[N],fz[N]\n" + "".join(
    f"{k},{10 * k}.5,20.0,-30.0,5.0,-60.0,0.0,0.0,0.0,-300.0\n" for k in range(5)
)
PLACES = "x[mm],y[mm],z[mm],fx[N],fy[N],fz[N]\n1500.0,100.0,200.0,0,0,-300.0\n"


def desk(folder: Path) -> None:
    """Input files as users have them."""
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copytree(SK120, folder / "rob", ignore=shutil.ignore_patterns("data"))
    (folder / "m.csv").write_bytes((SK120 / "data" / "table2_measured.csv").read_bytes())
    (folder / "mod.yaml").write_bytes((SK120 / "model.yaml").read_bytes())
    settings = (SK120 / "data" / "table2_measured.yaml").read_text(encoding="utf-8")
    extra = "noise: {sigma: 20.0, unit: um}\n"
    (folder / "m.yaml").write_text(settings + extra, encoding="utf-8")
    (folder / "path.csv").write_text(PATH)
    (folder / "place.csv").write_text(PLACES)


COMMANDS = {  # what is mutated → commands that read it, the cheap ones often
    "m.csv": [
        "predict @mod.yaml @m.csv", "predict @mod.yaml @m.csv --out @p.csv", "identify @m.csv",
        "identify @m.csv --robust", "simulate @mod.yaml @m.csv --out @s.csv",
        "explain @m.csv --no-report --out @e",
    ],
    "m.yaml": ["predict @mod.yaml @m.csv", "identify @m.csv", "plan --data @m.csv --count 2"],
    "mod.yaml": [
        "stiffness @rob --model @mod.yaml --wrench 0,0,-100N", "predict @mod.yaml @m.csv",
        "identify @m.csv --model @mod.yaml", "export @mod.yaml --out @x.xml",
        "compensate @mod.yaml @path.csv --out @c.csv",
    ],
    "rob/robot.yaml": ["check @rob", "stiffness @rob", "predict @rob/model.yaml @m.csv"],
    "rob/sk120.urdf": ["check @rob", "stiffness @rob --wrench 0,0,-100N",
        "view @rob --static @v.html"],
    "path.csv": ["compensate @mod.yaml @path.csv --out @c.csv"],
}  # fmt: skip


def mutated_inputs(folder: Path, kind: str, seeds: range, explain_every: int) -> Iterator[Verdict]:
    """Mutate one kind of file and run a command on it, once for each seed.

    Parameters
    ----------
    kind
        Key of `COMMANDS`.
    explain_every
        How many of the runs that `explain` would have are really made: it takes seconds.
    """
    desk(folder)
    target = folder / kind
    text = target.read_text(encoding="utf-8")
    mutate = {".csv": mutated_csv, ".yaml": mutated_yaml, ".urdf": mutated_xml}[target.suffix]
    for seed in seeds:
        command = random.Random(f"{kind}{seed}").choice(COMMANDS[kind])
        if command.startswith("explain") and seed % explain_every:
            command = "identify @m.csv --json"
        target.write_bytes(mutate(text, seed))
        words = command.replace("@", f"{folder}/").split()
        yield here(f"{kind} seed {seed}: {command}", *words)
    target.write_text(text, encoding="utf-8")
