"""Files that are one result appear together, or none does."""

import os
import signal
from contextlib import suppress
from pathlib import Path

import pytest

from sk120stiff.errors import InputError
from sk120stiff.files import (
    note_read,
    read_bytes,
    read_text,
    remembered,
    running,
    together,
    will_fill,
    will_write,
    write_atomically,
)


def names(folder: Path) -> dict[str, str]:
    return {path.name: path.read_text() for path in folder.iterdir()}


def test_the_old_files_stay_until_all_new_ones_are_written(tmp_path: Path) -> None:
    for name in ("verdict", "model", "page"):
        (tmp_path / name).write_text("old")
    with together(stale=[tmp_path / "page"], last=tmp_path / "verdict"):
        write_atomically(tmp_path / "verdict", "new")
        write_atomically(tmp_path / "model", "new")
        assert {n: t for n, t in names(tmp_path).items() if t == "old"}.keys() == {
            "verdict", "model", "page"
        }  # fmt: skip
    assert names(tmp_path) == {"verdict": "new", "model": "new"}


@pytest.mark.parametrize("error", [KeyboardInterrupt, OSError(28, "full"), MemoryError])
def test_whatever_fails_leaves_the_folder_as_it_was(tmp_path: Path, error) -> None:
    (tmp_path / "model").write_text("old")

    def fail() -> None:
        with together(last=tmp_path / "verdict"):
            write_atomically(tmp_path / "model", "new")
            write_atomically(tmp_path / "new" / "deeper" / "file", "new")
            raise error

    with pytest.raises(error if isinstance(error, type) else type(error)):
        fail()
    assert names(tmp_path) == {"model": "old"}


def test_ctrl_c_in_the_moment_of_change_waits(tmp_path: Path, monkeypatch) -> None:
    replace = os.replace

    def interrupted(source: str, target: str) -> None:
        os.kill(os.getpid(), signal.SIGINT)
        replace(source, target)

    monkeypatch.setattr("os.replace", interrupted)

    def work() -> None:
        with together(last=tmp_path / "a"):
            for name in "abc":
                write_atomically(tmp_path / name, "new")

    with pytest.raises(KeyboardInterrupt):
        work()
    assert names(tmp_path) == dict.fromkeys("abc", "new")


def test_a_full_disk_leaves_the_old_file(tmp_path: Path) -> None:
    """A limit on the size of files stands for the disk: the process gets the same kind of error."""
    import resource

    target = tmp_path / "model.yaml"
    target.write_text("old")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))
    try:
        with pytest.raises(OSError, match="too large"):
            write_atomically(target, "x" * 100_000)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, ignored)
    assert names(tmp_path) == {"model.yaml": "old"}


def test_reading_and_declaring_meet_in_either_order(tmp_path: Path) -> None:
    file = tmp_path / "m.csv"
    file.write_text("x")
    with running():
        read_text(file)
        with pytest.raises(InputError, match=r"would overwrite m\.csv"):
            will_write(file)
        with pytest.raises(InputError, match=r"would overwrite m\.csv"):
            write_atomically(file, "y")
        with pytest.raises(InputError, match=r"would overwrite m\.csv"):
            will_fill(tmp_path)
    with running():
        will_write(file, "--page")
        with pytest.raises(InputError, match=r"--page .*would overwrite m\.csv"):
            note_read(file)
    with running():
        will_fill(tmp_path)
        with pytest.raises(InputError, match=r"would overwrite m\.csv"):
            note_read(file)
    with running():  # what the run has made itself may be read and written again
        write_atomically(file, "y")
        assert read_text(file) == "y"
        write_atomically(file, "z")
    assert read_text(file) == "z"


def test_a_library_call_may_rewrite_what_it_has_read(tmp_path: Path) -> None:
    file = tmp_path / "m.yaml"
    file.write_text("x")
    read_text(file)
    write_atomically(file, "y")
    assert file.read_text() == "y"


def test_a_device_without_end_is_refused() -> None:
    with pytest.raises(InputError, match="larger than 250 MB"):
        read_bytes("/dev/zero")


def test_a_workbook_is_told_from_text(tmp_path: Path) -> None:
    path = tmp_path / "readings.xlsx"
    path.write_bytes(b"PK\x03\x04" + bytes(range(128, 256)))
    with pytest.raises(InputError, match="this is a workbook") as refused:
        read_text(path)
    assert "sk120stiff import readings.xlsx" in str(refused.value.remedy)


def test_an_interrupt_that_was_swallowed_stops_before_a_file_is_written(tmp_path: Path) -> None:
    def swallowed() -> None:
        with suppress(KeyboardInterrupt):  # as a library that catches everything
            signal.raise_signal(signal.SIGINT)

    def one_file() -> None:
        swallowed()
        write_atomically(tmp_path / "a.txt", "never")

    def a_set() -> None:
        with together():
            write_atomically(tmp_path / "a.txt", "never")
            swallowed()

    for written in (one_file, a_set):
        with remembered(), pytest.raises(KeyboardInterrupt):
            written()
        assert not any(tmp_path.iterdir())
    write_atomically(tmp_path / "a.txt", "now")  # what was asked of an earlier run is done
    assert (tmp_path / "a.txt").read_text() == "now"


def test_an_interrupt_that_is_ignored_stays_so() -> None:
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)  # as of nohup
    try:
        with remembered():
            signal.raise_signal(signal.SIGINT)
    finally:
        signal.signal(signal.SIGINT, before)
