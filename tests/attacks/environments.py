"""Attacks through what surrounds a process: streams, variables, folders, limits."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from tests.attacks.inputs import desk
from tests.attacks.judge import Verdict, apart

CLOSED, FULL, GONE = "closed", "/dev/full", "reader gone"
SILENT = (0, 1, 2, 3, 141)  # where nobody can hear it, an exit code says it

VARIABLES: list[dict[str, str | None]] = [
    {"LANG": "C", "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
    {"LC_ALL": "POSIX"}, {"LC_ALL": "xx_YY.UTF-99"}, {"LANG": None, "LC_ALL": None},
    *({"PYTHONIOENCODING": name} for name in ("latin-1", "cp1252", "ascii", "cp437", "koi8-r",
      "utf-16", "shift_jis", "ascii:strict", "latin-1:strict", "utf-7")),
    *({"NUMBA_NUM_THREADS": text} for text in ("0", "-1", "x", "", "1000000")),
    *({"OMP_NUM_THREADS": text} for text in ("0", "-5", "x", "")),
    {"OPENBLAS_NUM_THREADS": "x"}, {"MKL_NUM_THREADS": "0"}, {"NUMEXPR_MAX_THREADS": "x"},
    *({"MPLBACKEND": text} for text in ("QtAgg", "nonsense", "module://no.such", "", "TkAgg")),
    {"NUMBA_DISABLE_JIT": "0"}, {"NUMBA_THREADING_LAYER": "nonsense"}, {"NUMBA_DEBUG": "x"},
    {"NUMBA_CACHE_DIR": "/proc/nowhere"}, {"NUMBA_CACHE_DIR": "/dev/null/x"},
    {"NUMBA_OPT": "x"}, {"NUMBA_CPU_NAME": "generic"},
    {"MPLCONFIGDIR": "/proc/nowhere"}, {"MPLCONFIGDIR": "/dev/null/x"}, {"MATPLOTLIBRC": "/"},
    {"HOME": None}, {"HOME": "/nonexistent"}, {"HOME": "/dev/null"}, {"HOME": ""},
    {"HOME": "/proc", "XDG_CACHE_HOME": "/proc", "XDG_CONFIG_HOME": "/proc"},
    {"XDG_CACHE_HOME": "relative"}, {"TMPDIR": "/nonexistent"}, {"TMPDIR": "/proc"},
    {"TERM": "dumb"}, {"TERM": ""}, {"TERM": None}, {"TERM": "nonsense"},
    {"COLUMNS": "1"}, {"COLUMNS": "0"}, {"COLUMNS": "-4"}, {"COLUMNS": "x"}, {"COLUMNS": "100000"},
    {"LINES": "0"}, {"NO_COLOR": "1"}, {"FORCE_COLOR": "1"}, {"FORCE_COLOR": "1", "COLUMNS": "1"},
    {"CLICOLOR_FORCE": "1"}, {"TTY_COMPATIBLE": "1"}, {"TTY_INTERACTIVE": "1", "TERM": "dumb"},
    {"PYTHONOPTIMIZE": "1"}, {"PYTHONOPTIMIZE": "2"}, {"PYTHONDONTWRITEBYTECODE": "1"},
    {"PYTHONWARNINGS": "error"}, {"PYTHONWARNINGS": "error::UserWarning"}, {"PYTHONDEVMODE": "1"},
    {"PYTHONWARNINGS": "nonsense"}, {"PYTHONHASHSEED": "0"}, {"PYTHONUNBUFFERED": "1"},
    {"PYTHONNOUSERSITE": "1"}, {"PYTHONINTMAXSTRDIGITS": "640"}, {"PYTHONMALLOC": "malloc"},
    {"ROS_PACKAGE_PATH": ":::/nonexistent:/dev/null:"}, {"AMENT_PREFIX_PATH": "\udcff\udcfe"},
    {"ROS_PACKAGE_PATH": "x" * 5000}, {"TZ": "nonsense"}, {"SOURCE_DATE_EPOCH": "x"},
    {"PATH": ""}, {"PATH": None}, {"BROWSER": "/nonexistent"}, {"LD_BIND_NOW": "1"},
]  # fmt: skip
COMMANDS = ("identify m.csv", "stiffness rob --wrench 0,0,-100N --json")
DRAWING = ("view rob --static v.html", "paper --out paper")
STREAMS = [
    (stdout, stderr)
    for stdout in (None, CLOSED, FULL, GONE)
    for stderr in (None, CLOSED, FULL, GONE)
]
LIMITS = {
    "16 open files": "import resource as r; r.setrlimit(r.RLIMIT_NOFILE, (16, 16))",
    "64 open files": "import resource as r; r.setrlimit(r.RLIMIT_NOFILE, (64, 64))",
    "files of 4 kB": "import resource as r, signal as s; s.signal(s.SIGXFSZ, s.SIG_IGN); "
    "r.setrlimit(r.RLIMIT_FSIZE, (4096, 4096))",
    "a stack of 1 MB": "import resource as r; r.setrlimit(r.RLIMIT_STACK, (2**20, 2**20))",
    "4 GB of address space": "import resource as r; r.setrlimit(r.RLIMIT_AS, (2**32, 2**32))",
    "no stdin": "import os; os.close(0)",
    "a working folder that is gone": "import os, tempfile; d = tempfile.mkdtemp(); os.chdir(d); "
    "os.rmdir(d)",
    "recursion of 300": "import sys; sys.setrecursionlimit(300)",
}


def variables(folder: Path, count: int | None = None) -> Iterator[Verdict]:
    """Every set of variables, with a command that computes and, for some, one that draws."""
    desk(folder)
    for k, each in enumerate(VARIABLES[:count]):
        drawn = any(name.startswith(("MPL", "MATPLOTLIB", "HOME")) for name in each)
        command = DRAWING[0] if drawn and k % 2 else DRAWING[1] if drawn else COMMANDS[k % 2]
        told = " ".join(f"{n}={'(unset)' if v is None else repr(v[:30])}" for n, v in each.items())
        yield apart(f"{told}: {command}", command.split(), environment=each, cwd=folder)


def streams(folder: Path) -> Iterator[Verdict]:
    """Standard streams that are closed, full, or that nobody reads any more."""
    desk(folder)
    for stdout, stderr in STREAMS:
        for command in ("identify m.csv", "predict gone.yaml m.csv", "--help"):
            before, handles, options = "", [], {}
            for number, name, kind in ((1, "stdout", stdout), (2, "stderr", stderr)):
                if kind == CLOSED:
                    options[name] = subprocess.DEVNULL
                    before += f"import os; os.close({number}); sys.{name} = None; "
                elif kind == FULL:
                    handles.append(os.open(FULL, os.O_WRONLY))
                    options[name] = handles[-1]
                elif kind == GONE:
                    read, write = os.pipe()
                    os.close(read)
                    handles.append(write)
                    options[name] = write
            attack = f"stdout {stdout or 'fine'}, stderr {stderr or 'fine'}: {command}"
            yield apart(
                attack, command.split(), before=before, cwd=folder,
                codes=SILENT, **options,
            )  # fmt: skip
            for handle in handles:
                os.close(handle)


def limits(folder: Path) -> Iterator[Verdict]:
    """Limits of the process, with a command that writes."""
    desk(folder)
    for name, before in LIMITS.items():
        command = f"identify {folder}/m.csv --out {folder}/found.yaml"
        yield apart(
            f"{name}: {command}", command.split(), before=before, cwd=folder, codes=(0, 1, 2, 3)
        )


# Without these even root is a stranger where the folder's mode says so.
STRIPPED = ("setpriv", "--bounding-set=-dac_override,-dac_read_search", "--inh-caps=-all")


UNWRITABLE = (
    "identify m.csv", "identify m.csv --out x.yaml", "identify m.csv --out m.csv",
    "view rob --static v.html", "explain m.csv --out e", "new rob --out mine",
    "predict mod.yaml m.csv --out mod.yaml", "paper --out p",
    "map rob --grid joint_2_l=0:9:3deg --out m.zarr",
)  # fmt: skip


def _stranger() -> Sequence[str] | None:
    """Words that start a program as one who may write only where modes allow; None: no such way."""
    if os.geteuid() != 0:
        return ()
    try:
        done = subprocess.run([*STRIPPED, sys.executable, "-c", ""], check=False)
    except OSError:
        return None
    return STRIPPED if done.returncode == 0 else None


def strangers(folder: Path) -> Iterator[Verdict]:
    """A folder in which nothing may be written, and a home that is not there."""
    desk(folder)
    under = _stranger()
    if under is None:
        return
    places = [*folder.rglob("*"), folder]
    for path in places:
        path.chmod(0o555 if path.is_dir() else 0o444)
    try:
        for command in UNWRITABLE:
            told = f"in a folder that is write-protected: {command}"
            yield apart(
                told, command.split(), cwd=folder, under=under, environment={"HOME": "/nonexistent"}
            )
    finally:
        for path in places[::-1]:
            path.chmod(0o755 if path.is_dir() else 0o644)
