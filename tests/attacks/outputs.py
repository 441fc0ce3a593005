"""Attacks through outputs: names of inputs, links, folders of others, interrupts while writing."""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from tests.attacks.judge import Verdict, here, leftovers

SK120 = Path(__file__).resolve().parents[2] / "robots" / "motoman_sk120"
JOINTS = ",".join(f"joint_{k}_{c}[deg]" for k, c in enumerate("slurbt", start=1))
GRID = ("--grid", "joint_2_l=0:20:10 deg")

ATTACKS = [
    "predict mod.yaml m.csv --out m.csv",
    "predict mod.yaml m.csv --out m.yaml",
    "predict mod.yaml m.csv --out mod.yaml",
    "predict mod.yaml m.csv --out rob/sk120.urdf",
    "predict mod.yaml m.csv --out rob/robot.yaml",
    "predict mod.yaml m.csv --out hard.csv",
    "predict mod.yaml m.csv --out soft.csv",
    "predict mod.yaml m.csv --out rob/../m.csv",
    "identify m.csv --out rob/model.yaml",
    "identify m.csv --model mod.yaml --out mod.yaml",
    "identify m.csv --model mod.yaml --out rob/sk120.urdf",
    "identify m.csv --out m.yaml",
    "view rob --static rob/sk120.urdf",
    "view rob --static rob/robot.yaml",
    "view rob --static rob/model.yaml",
    "view rob/sk120.urdf --static rob/sk120.urdf",
    "view rob --data m.csv --static m.csv",
    "view meshed.urdf --static cube.stl",
    "explain m.csv --model result/model.yaml --out result",
    "explain inn/m.csv --out inn",
    "explain m.csv --out rob",
    "demo --out rob",
    "export mod.yaml --out mod.yaml --to mjcf",
    "export mod.yaml --out rob/sk120.urdf --to sdf",
    "compensate mod.yaml path.csv --out path.csv",
    "compensate mod.yaml path.csv --to csv --out mod.yaml",
    "compensate mod.yaml path.csv --against truth.yaml --to csv --out truth.yaml",
    "posture mod.yaml place.csv --out place.csv",
    "posture mod.yaml place.csv --out best.csv --page mod.yaml",
    "posture mod.yaml place.csv --out best.csv --page rob/sk120.urdf",
    "posture mod.yaml place.csv --out best.csv --page best.csv",
    "simulate mod.yaml m.csv --out m.csv",
    "simulate mod.yaml m.csv --out mod.csv",
    "plan --model mod.yaml --count 3 --data m.csv --out m.csv",
    "import marks.csv --robot rob --out marks.csv",
    "map rob GRID --out rob --overwrite",
    "map rob GRID --out . --overwrite",
    "map rob GRID --out new.zarr --page rob/model.yaml",
]


def desk_of_outputs(folder: Path) -> None:
    """A folder as users have it, with links and files of other programs."""
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copytree(SK120, folder / "rob", ignore=shutil.ignore_patterns("data"))
    model = (SK120 / "model.yaml").read_text(encoding="utf-8")
    for place in (".", "inn", "result"):
        (folder / place).mkdir(exist_ok=True)
        (folder / place / "m.csv").write_bytes(
            (SK120 / "data" / "table2_measured.csv").read_bytes()
        )
        settings = (SK120 / "data" / "table2_measured.yaml").read_text(encoding="utf-8")
        lines = [line for line in settings.splitlines() if not line.startswith("robot:")]
        robot = "rob" if place == "." else "../rob"
        (folder / place / "m.yaml").write_text("\n".join([f"robot: {robot}", *lines]))
        (folder / place / "model.yaml").write_text(model, encoding="utf-8")
    (folder / "result" / "verdict.json").write_text('{"verdict": "none"}')
    text = "\n".join(line for line in model.splitlines() if not line.startswith("robot:"))
    for name in ("mod.yaml", "truth.yaml"):
        (folder / name).write_text(f"robot: rob\n{text}\n", encoding="utf-8")
    os.link(folder / "m.csv", folder / "hard.csv")
    (folder / "soft.csv").symlink_to("m.csv")
    (folder / "path.csv").write_text(f"{JOINTS},fx[N],fy[N],fz[N]\n0,0,0,0,0,0,0,0,-100\n")
    (folder / "place.csv").write_text("x[mm],y[mm],z[mm],fx[N],fy[N],fz[N]\n1500,0,0,0,0,-1\n")
    (folder / "marks.csv").write_text("x1,y1,z1,q1\n0,0,0,0\n")
    (folder / "cube.stl").write_text("solid none\nendsolid none\n")
    shape = '<visual><geometry><mesh filename="cube.stl"/></geometry></visual>'
    (folder / "meshed.urdf").write_text(
        f'<robot name="r"><link name="a">{shape}</link><link name="b"/><joint name="j" '
        'type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint></robot>'
    )
    # A folder that somebody else's software would take for a map.
    (folder / "zarr.json").write_text("{}")
    (folder / "rob" / "zarr.json").write_text("{}")


def content(folder: Path) -> dict[str, bytes]:
    return {
        str(file.relative_to(folder)): file.read_bytes()
        for file in sorted(folder.rglob("*"))
        if file.is_file()
    }


def words_of(attack: str) -> list[str]:
    """Arguments of one of `ATTACKS`."""
    return [part for word in attack.split() for part in (GRID if word == "GRID" else (word,))]


def overwriting(folder: Path) -> Iterator[Verdict]:
    """Every way in which an output could replace an input: exit 2, every byte as before."""
    desk_of_outputs(folder)
    before, home = content(folder), Path.cwd()
    os.chdir(folder)
    try:
        for attack in ATTACKS:
            found = here(attack, *words_of(attack), codes=(2,))
            changed = [name for name, data in content(folder).items() if before.get(name) != data]
            yield Verdict(attack, found.loss or ", ".join(changed), found.seconds)
    finally:
        os.chdir(home)


def interrupts(folder: Path, count: int = 10, seed: int = 0) -> Iterator[Verdict]:
    """Ctrl-C and kills at random moments: whole old results or whole new ones, nothing beside."""
    desk_of_outputs(folder)
    out, draw = folder / "out", random.Random(seed)
    words = ["explain", str(folder / "m.csv"), "--out", str(out), "--no-report"]
    command = [sys.executable, "-m", "sk120stiff", *words]
    begin = time.monotonic()
    subprocess.run(command, check=True, capture_output=True)
    took = time.monotonic() - begin
    for k in range(count):
        before = content(out)
        sent = signal.SIGINT if k % 3 else signal.SIGKILL
        process = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
        )
        time.sleep(draw.uniform(0.0, took))
        process.send_signal(sent)
        said = process.communicate()[1]
        after = content(out)
        loss = "Traceback" if "Traceback" in said and process.returncode not in (0, -2) else ""
        if set(before) - set(after) or not (out / "verdict.json").is_file():
            loss = f"lost: {sorted(set(before) - set(after))}"
        if sent == signal.SIGINT and leftovers(out):
            loss = f"left behind: {leftovers(out)}"
        for name in leftovers(out):
            (out / name).unlink()
        yield Verdict(f"{sent.name} {k}: explain", loss)
