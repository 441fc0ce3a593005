"""How fast it is, beside other means of doing the same, in one run: a table, and JSON on request.

    python scripts/bench.py [--seconds 3] [--json FILE] [--only speed,growth,…]

Peers come with `pip install "sk120stiff[bench]"`; one that is not installed is named as absent.
Every road runs in a process of its own that is held to one core (or to all of them), and the best
of several runs counts, so other work on the machine shows as little as possible.
"""

from __future__ import annotations

import argparse
import datetime as dt
import importlib.metadata
import json
import os
import platform
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))  # for bench_roads


@dataclass(frozen=True)
class Row:
    """One measured number, or the reason why there is none."""

    group: str
    what: str
    value: float | None
    unit: str
    note: str = ""


ROUNDS = 3  # of all roads in turns, so that what else the machine does falls on all of them


def speed(seconds: float) -> Iterator[Row]:
    """Every road on one core, and the kernel on all of them, in turns; the best round counts."""
    import bench_roads as roads

    cores = len(os.sched_getaffinity(0))
    jobs = {name: (name, 1) for name in roads.ROADS}
    if cores > 1:
        jobs["all cores"] = ("kernel", cores)
    rates: dict[str, float] = {}
    notes: dict[str, str] = {}
    for _ in range(ROUNDS):
        for job, (road, many) in jobs.items():
            if job in notes:
                continue
            value, note = on_cores(road, seconds / ROUNDS, many)
            if value is None:
                notes[job] = note
            else:
                rates[job] = max(rates.get(job, 0.0), value)
    kernel = rates.get("kernel")
    for name, (_, title) in roads.ROADS.items():
        note = notes.get(name, "")
        if kernel and name in rates and name != "kernel":
            ratio = kernel / rates[name]
            note = f"the kernel is {ratio:.{1 if ratio < 10 else 0}f} times as fast"
        yield Row("speed, 6R, one core", title, rates.get(name), "poses/s", note)
    if kernel and "all cores" in rates:
        value = rates["all cores"]
        note = f"{value / kernel:.2f} times one core"
        yield Row("speed, 6R, all cores", f"batch kernel on {cores} cores", value, "poses/s", note)


def on_cores(road: str, seconds: float, cores: int) -> tuple[float | None, str]:
    """Run one road in a process held to some cores: its rate, or why there is none."""
    command = [sys.executable, __file__, "--road", road, "--cores", str(cores)]
    done = subprocess.run(
        [*command, "--seconds", str(seconds)],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "OMP_NUM_THREADS": str(cores), "OPENBLAS_NUM_THREADS": str(cores)},
    )
    if done.returncode:
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        missing = "ModuleNotFoundError" in last or "ImportError" in last
        return None, f"absent: {last.split(': ', 1)[-1]}" if missing else f"failed: {last}"
    return float(done.stdout.split()[-1]), ""


def road_here(name: str, seconds: float, cores: int) -> None:
    """Body of the process that `on_cores` starts."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, set(sorted(os.sched_getaffinity(0))[:cores]))
    import bench_roads as roads

    if name == "kernel":
        print(roads.kernel(seconds, threads=cores))
    else:
        print(roads.ROADS[name][0](seconds))


def growth(seconds: float) -> Iterator[Row]:
    """How the cost of the kernel grows with the number of poses and of joints."""
    import bench_roads as roads

    for count in (1, 100, 10_000, 1_000_000):
        value = roads.kernel(seconds / 4, count=count)
        yield Row("growth with N", f"{count:,} poses", 1e6 * count / value, "µs a call")
    for joints in (2, 3, 4, 6, 7, 9, 12):
        value = roads.kernel(seconds / 4, count=100_000, joints=joints)
        yield Row("growth with joints", f"{joints} joints", 1e9 / value, "ns a pose")


def start(_seconds: float) -> Iterator[Row]:
    """What a user waits for before anything is computed."""
    commands = {
        "sk120stiff --help": "from sk120stiff.cli.main import main; main(['--help'])",
        "load the bundled robot": "import sk120stiff; sk120stiff.load_robot('motoman_sk120')",
        "first batch, compiled code found": (
            "import sk120stiff as s, numpy as n\n"
            "from sk120stiff.stiffness import ConstantCompliance, under_load\n"
            "r = s.load_robot('motoman_sk120')\n"
            "arm = ConstantCompliance.of_springs(r, n.ones(6))\n"
            "under_load(arm, n.zeros((1, 6)), n.zeros(6))"
        ),
    }
    for what, program in commands.items():
        best = min(_process(program) for _ in range(3))
        yield Row("start", what, best, "s")
    empty = min(_process("pass") for _ in range(3))
    yield Row("start", "an empty Python process, for comparison", empty, "s")


def _process(program: str) -> float:
    begin = time.perf_counter()
    subprocess.run([sys.executable, "-c", program], check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - begin


def tasks(seconds: float) -> Iterator[Row]:
    """How long the main jobs take, and how that grows with readings and candidates."""
    import bench_tasks as jobs

    group = "identification"
    found = selection(lambda: jobs.table_2_identification(seconds))
    yield Row(group, "the paper's measured data, read and identified", found[0], "s", found[1])
    for count in (30, 100, 1_000, 10_000):
        found = selection(lambda count=count: jobs.identification(count, seconds / 2))
        yield Row(group, f"{count:,} readings, three springs", found[0], "s", found[1])
    for count in (100, 1_000, 10_000):
        found = selection(lambda count=count: jobs.prediction(count, seconds / 2))
        yield Row(group, f"{count:,} readings predicted", found[0], "s", found[1])
    for count in (100, 2_000):
        found = selection(lambda count=count: jobs.slip_search(count))
        yield Row(
            group, f"{count:,} readings searched for slips of the pen", found[0], "s", found[1]
        )
    found = selection(lambda: jobs.sensitivities(seconds / 2))
    yield Row(group, "100 readings, sensitivities of two effects", found[0], "s", found[1])
    group = "explain"
    for count, candidates in ((50, 3), (100, 3), (200, 3), (100, 6), (100, 0)):
        which = f"{candidates} kinds of effect" if candidates else "the whole catalogue"
        found = selection(lambda count=count, some=candidates: jobs.explanation(count, some))
        yield Row(group, f"{count} readings, {which}", found[0], "s", found[1])
    for count in (100, 500, 2_000):
        found = selection(lambda count=count: jobs.explanation(count, 0, remainder=0.06))
        what = f"{count:,} readings of an arm that keeps to no law within 6 %"
        yield Row(group, what, found[0], "s", found[1])
    found = selection(lambda: jobs.live_frame(seconds) * 1e3)
    yield Row("view", "one request of the live page, answered", found[0], "ms", found[1])


def selection(work: Callable[[], float]) -> tuple[float | None, str]:
    """A number, or why there is none."""
    try:
        return work(), ""
    except ImportError as error:
        return None, f"absent: {error}"


#: What `--only` chooses from, in the order of the table.
MEASUREMENTS: dict[str, Callable[[float], Iterator[Row]]] = {
    "speed": speed,
    "growth": growth,
    "tasks": tasks,
    "start": start,
}


def machine() -> dict[str, object]:
    """On what this was measured."""
    model = platform.processor()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        named = [x for x in cpuinfo.read_text().splitlines() if x.startswith("model name")]
        model = named[0].split(":", 1)[1].strip() if named else model
    versions = {}
    for name in ("numpy", "numba", "pin", "jax", "frax", "roboticstoolbox-python"):
        try:
            versions[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            versions[name] = "absent"
    return {
        "date": dt.datetime.now(dt.UTC).date().isoformat(),
        "processor": model,
        "cores": len(os.sched_getaffinity(0)),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "load": os.getloadavg()[0],
        **versions,
    }


def print_table(rows: list[Row], about: dict[str, object]) -> None:
    """The rows as text."""
    print(", ".join(f"{key} {value}" for key, value in about.items()))
    group = ""
    for row in rows:
        if row.group != group:
            group = row.group
            print(f"\n{group}")
        number = "—" if row.value is None else f"{row.value:,.4g}"
        if row.value is not None and row.value >= 1e4:
            number = f"{row.value:,.0f}"
        print(f"  {row.what:<58}{number:>14} {row.unit:<10} {row.note}")


def main() -> int:
    """Measure, print, and write JSON where asked to."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=3.0, help="time for each number")
    parser.add_argument("--json", type=Path, help="file to write the numbers to")
    parser.add_argument("--only", default=",".join(MEASUREMENTS), help="which measurements")
    parser.add_argument("--road", help=argparse.SUPPRESS)
    parser.add_argument("--cores", type=int, default=1, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.road:
        road_here(given.road, given.seconds, given.cores)
        return 0
    chosen = given.only.split(",")
    unknown = [name for name in chosen if name not in MEASUREMENTS]
    if unknown:
        parser.error(f"no measurement {', '.join(unknown)}; there are {', '.join(MEASUREMENTS)}")
    about = machine()
    rows: list[Row] = []
    for name in chosen:
        for row in MEASUREMENTS[name](given.seconds):
            print(f"{row.group}: {row.what}", file=sys.stderr)
            rows.append(row)
    print_table(rows, about)
    if given.json:
        from sk120stiff.files import write_atomically

        document = {"machine": about, "rows": [asdict(row) for row in rows]}
        write_atomically(given.json, json.dumps(document, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
