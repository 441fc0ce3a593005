"""What a process is started from must not break what it says."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from sk120stiff.cli.environment import prepare

STIFFNESS = ("stiffness", "motoman_sk120", "--wrench", "0,0,-490 N")


def started(*arguments: str, before: str = "", **environment: str) -> subprocess.CompletedProcess:
    code = f"import sys\n{before}\nfrom sk120stiff.cli.main import main\nsys.exit(main())"
    return subprocess.run(
        [sys.executable, "-c", code, *arguments],
        env={**os.environ, **environment},
        capture_output=True,
        check=False,
    )


@pytest.mark.parametrize("encoding", ["latin-1", "ascii:strict"])
def test_signs_that_a_stream_cannot_write_are_written_plainly(encoding: str) -> None:
    done = started(*STIFFNESS, PYTHONIOENCODING=encoding)
    text = done.stdout.decode(encoding.partition(":")[0])
    assert done.returncode == 0, done.stderr
    assert ("N/µm" if encoding == "latin-1" else "N/um") in text
    assert "\\u" not in text and "?" not in text


def test_closed_streams_are_told_by_the_exit_code() -> None:
    done = started(*STIFFNESS, before="import os; os.close(1); sys.stdout = None")
    assert done.returncode == 1
    assert b"standard output is closed" in done.stderr
    done = started(*STIFFNESS, before="import os; os.close(2); sys.stderr = None")
    assert (done.returncode, done.stderr) == (0, b"")
    assert "N/µm" in done.stdout.decode()


def test_the_next_file_does_not_become_a_closed_stream(tmp_path) -> None:
    code = (
        "import os\nos.close(1); os.close(2)\nfrom sk120stiff.cli.environment import prepare\n"
        f"prepare()\nprint(os.open({str(tmp_path / 'x')!r}, os.O_CREAT), file=open("
        f"{str(tmp_path / 'number')!r}, 'w'))"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
    assert int((tmp_path / "number").read_text()) > 2


@pytest.mark.parametrize("help_", [("--help",), ("stiffness", "--help")])
def test_help_on_a_full_disk_is_one_message(help_: tuple[str, ...]) -> None:
    with open("/dev/full", "wb") as full:
        code = "import sys; from sk120stiff.cli.main import main; sys.exit(main())"
        done = subprocess.run(
            [sys.executable, "-c", code, *help_], stdout=full, stderr=subprocess.PIPE, check=False
        )
    assert done.returncode == 3
    assert done.stderr == b"Error: No space left on device.\n"


def test_settings_that_no_library_can_use_are_ignored(tmp_path) -> None:
    done = started(
        *STIFFNESS,
        NUMBA_NUM_THREADS="0",
        PYTHONWARNINGS="error",
        COLUMNS="1",
        TERM="dumb",
        ROS_PACKAGE_PATH="x" * 5000,
        SOURCE_DATE_EPOCH="x",
    )
    assert done.returncode == 0, done.stderr
    assert b"NUMBA_NUM_THREADS='0' is no count; it is ignored." in done.stderr
    scene = tmp_path / "v.html"
    arguments = ("posture", "--help"), ("view", "motoman_sk120", "--static", str(scene))
    for each in arguments:
        done = started(*each, MPLBACKEND="module://no.such", HOME="/dev/null", MPLCONFIGDIR="/proc")
        assert done.returncode == 0, done.stderr
    assert scene.exists()


def test_preparing_twice_changes_nothing(monkeypatch) -> None:
    monkeypatch.setenv("NUMBA_NUM_THREADS", "2")
    prepare()
    prepare()
    assert os.environ["NUMBA_NUM_THREADS"] == "2"


def test_control_characters_of_labels_are_shown_and_not_obeyed(run, tmp_path) -> None:
    """A label may hold what clears a terminal or turns its text round."""
    folder = Path(__file__).resolve().parents[2] / "robots/motoman_sk120"
    lines = (folder / "data/table2_measured.csv").read_text(encoding="utf-8").splitlines()
    hostile = "\x1b[2J\u202ered"
    text = "\n".join([lines[0], *(hostile + line[1:] for line in lines[1:6])])
    (tmp_path / "m.csv").write_text(text, encoding="utf-8")
    (tmp_path / "m.yaml").write_bytes((folder / "data/table2_measured.yaml").read_bytes())
    said = run("predict", str(folder / "model.yaml"), str(tmp_path / "m.csv"))
    assert said.code == 0
    assert "\\x1b[2J\\u202ered" in said.stdout
    assert not {"\x1b", "\u202e"} & set(said.stdout + said.stderr)
    (tmp_path / "m.csv").write_text(text.replace("-0.03,", "x\x1b[2J,"), encoding="utf-8")
    said = run("predict", str(folder / "model.yaml"), str(tmp_path / "m.csv"))
    assert said.code == 2
    assert "\x1b" not in said.stderr
