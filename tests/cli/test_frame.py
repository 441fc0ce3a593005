"""Exit codes, messages and the separation of stdout and stderr, with commands made for the test."""

import logging
import os
import signal
import subprocess
import sys
import types
import warnings
from collections.abc import Callable
from pathlib import Path

import pytest

from sk120stiff.cli import main as entry
from sk120stiff.cli.frame import Answer, note
from sk120stiff.cli.tables import table
from sk120stiff.errors import InputError, MissingPart, Refusal, ToolkitWarning

Teach = Callable[[Callable[..., Answer]], None]


@pytest.fixture
def teach(monkeypatch: pytest.MonkeyPatch) -> Teach:
    """Make a function the program's command `probe`."""

    def install(body: Callable[..., Answer]) -> None:
        module = types.ModuleType("sk120stiff.cli.commands.probe")
        module.command = body  # type: ignore[attr-defined]
        monkeypatch.setitem(sys.modules, "sk120stiff.cli.commands.probe", module)
        monkeypatch.setitem(entry.COMMANDS, "probe", "A command made for the test.")

    return install


def failing_with(error: BaseException) -> Callable[[], Answer]:
    def command() -> Answer:
        raise error

    return command


def test_the_answer_goes_to_stdout_and_the_rest_to_stderr(run, teach) -> None:
    def command() -> Answer:
        note("base frame: base_link (the root)")
        logging.getLogger("sk120stiff.robot").info("reading")
        logging.getLogger("sk120stiff.robot").debug("byte by byte")
        for _ in range(3):
            warnings.warn("no masses,\n  gravity is zero", ToolkitWarning, stacklevel=1)
        return Answer({"values": [1.0]}, parts=["a stiffness of 1 N/m", table("T", ["a"], [[1.5]])])

    teach(command)
    spoken = run("probe")
    assert spoken.code == 0
    assert spoken.stdout.splitlines()[0] == "a stiffness of 1 N/m"
    assert "1.5" in spoken.stdout
    assert spoken.stderr.splitlines() == [
        "base frame: base_link (the root)",
        "reading",
        "Warning: no masses, gravity is zero",
    ]
    written = run("probe", "--json")
    warned = ["no masses, gravity is zero"]
    assert written.document == {"schema": 2, "warnings": warned, "values": [1.0]}
    assert written.stderr == spoken.stderr
    assert "byte by byte" in run("probe", "--debug").stderr


@pytest.mark.parametrize(
    ("error", "code", "message"),
    [
        (
            InputError("no unit", where="d.csv, column fx", remedy="Write fx[N]."),
            (2, "input"),
            "Error: d.csv, column fx: no unit. Write fx[N].\n",
        ),
        (Refusal("the arm is unstable"), (1, "refusal"), "Error: the arm is unstable.\n"),
        (
            MissingPart("distributed", needed_for="map"),
            (2, "input"),
            'pip install "sk120stiff[cluster]"',
        ),
        (KeyboardInterrupt(), (130, "interrupted"), "Interrupted."),
        (
            OSError(28, "No space left on device", "out.csv"),
            (3, "system"),
            "Error: out.csv: No space left",
        ),
        (MemoryError(), (3, "system"), "Error: not enough memory"),
        (
            ZeroDivisionError("division by zero"),
            (3, "internal"),
            "Internal error: ZeroDivisionError",
        ),
    ],
)
@pytest.mark.parametrize("extra", [(), ("--json",)])
def test_failures_are_one_message(run, teach, error, code, message, extra) -> None:
    teach(failing_with(error))
    outcome = run("probe", *extra)
    assert outcome.code == code[0]
    assert message in outcome.stderr
    if extra:
        assert outcome.error["kind"] == code[1]
        assert outcome.error["message"].rstrip(".") in outcome.stderr
    else:
        assert outcome.stdout == ""
    assert "Traceback" not in outcome.stderr


def test_debug_shows_where_in_the_code(run, teach) -> None:
    for error in (ZeroDivisionError("x"), InputError("no unit")):
        teach(failing_with(error))
        outcome = run("probe", "--debug")
        assert "Traceback" in outcome.stderr
        assert "in command" in outcome.stderr


def test_a_refusal_may_have_a_document(run, teach) -> None:
    teach(lambda: Answer({"verdict": "outside"}, exit_code=1))
    outcome = run("probe", "--json")
    document = outcome.document
    assert (outcome.code, document["verdict"], document["schema"]) == (1, "outside", 2)
    assert document["error"]["kind"] == "refusal"


def test_what_json_cannot_say_is_a_fault_of_the_program(run, teach) -> None:
    teach(lambda: Answer({"value": 1j}))
    outcome = run("probe", "--json")
    assert (outcome.code, outcome.error["kind"]) == (3, "internal")
    assert "Internal error: TypeError" in outcome.stderr


def test_a_command_whose_import_fails_is_reported(run, monkeypatch) -> None:
    monkeypatch.setitem(entry.COMMANDS, "absent", "A command without a file.")
    outcome = run("absent", "--json")
    assert (outcome.code, outcome.error["kind"]) == (3, "internal")
    assert "Internal error: ModuleNotFoundError" in outcome.stderr


@pytest.mark.parametrize(
    ("arguments", "hint"),
    [
        (("chek",), "Did you mean 'check'?"),
        (("check",), "Missing argument 'ROBOT|MODEL'"),
        (("check", "a", "--nonsense"), "No such option: --nonsense"),
        (("check", "--robot", "a"), "the robot is given without an option: "),
        (("explain", "a.csv", "--robot", "b"), "the robot stands in the YAML file beside"),
        (("predict", "--model", "a", "b.csv"), "predict MODEL|ROBOT DATA"),
        (("check", "a", "b"), "unexpected extra argument"),
        (("--nonsense",), "No such option"),
    ],
)
def test_bad_usage_is_one_message(run, arguments, hint) -> None:
    outcome = run(*arguments)
    assert (outcome.code, outcome.stdout) == (2, "")
    assert outcome.stderr.count("Error:") == 1
    assert hint in outcome.stderr
    told = run(*arguments, "--json").error
    assert told["kind"] == "usage"
    assert hint in f"{told['message']} {told['remedy']}" or "--json" in told["message"]


def test_a_failure_after_the_answer_prints_no_second_document(run, teach) -> None:
    """A server that falls over later leaves the one document that was printed."""

    def fall() -> None:
        raise ZeroDivisionError("x")

    teach(lambda: Answer({"url": "here"}, afterwards=fall))
    outcome = run("probe", "--json")
    assert (outcome.code, outcome.document["url"]) == (3, "here")


def test_nobody_reads_on(tmp_path: Path) -> None:
    """`sk120stiff … | head -0` ends quietly."""
    script = tmp_path / "flood.py"
    script.write_text(
        "import sys, types\n"
        "from sk120stiff.cli import main as entry\n"
        "from sk120stiff.cli.frame import Answer\n"
        "module = types.ModuleType('sk120stiff.cli.commands.probe')\n"
        "module.command = lambda: Answer({'x': list(range(1_000_000))})\n"
        "sys.modules[module.__name__] = module\n"
        "entry.COMMANDS['probe'] = 'Flood.'\n"
        "sys.exit(entry.main(['probe', '--json']))\n"
    )
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run(
        [sys.executable, str(script)], stdout=write, stderr=subprocess.PIPE, text=True, check=False
    )
    os.close(write)
    assert (done.returncode, done.stderr) == (141, "")


def test_ctrl_c_leaves_the_old_file(tmp_path: Path) -> None:
    """An interrupted command exits 130 and leaves neither half a file nor a temporary one."""
    target = tmp_path / "model.yaml"
    target.write_text("old")
    script = tmp_path / "slow.py"
    script.write_text(
        "import os, sys, time, types\n"
        "from sk120stiff.cli import main as entry\n"
        "from sk120stiff.cli.frame import note\n"
        "from sk120stiff import files\n"
        "def command():\n"
        "    def slow(*_):\n"
        "        note('writing')\n"
        "        time.sleep(60)\n"
        "    os.replace = slow\n"
        f"    files.write_atomically({str(target)!r}, 'new')\n"
        "module = types.ModuleType('sk120stiff.cli.commands.probe')\n"
        "module.command = command\n"
        "sys.modules[module.__name__] = module\n"
        "entry.COMMANDS['probe'] = 'Slow.'\n"
        "sys.exit(entry.main(['probe']))\n"
    )
    process = subprocess.Popen(
        [sys.executable, str(script)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stderr is not None
    assert process.stderr.readline() == "writing\n"
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=30)
    assert (process.returncode, out) == (130, "")
    assert err.startswith("Interrupted.")
    assert target.read_text() == "old"
    assert {path.name for path in tmp_path.iterdir()} == {"model.yaml", "slow.py"}
