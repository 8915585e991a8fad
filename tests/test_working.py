"""What a command says while one waits: nothing at first, plain lines in a pipe, one line on a terminal of which nothing is left."""

from __future__ import annotations

import fcntl
import os
import pty
import re
import struct
import sys
import termios
import time
from pathlib import Path

import pytest
from program import listen, told
from test_table import row

from benchbench.run import working
from benchbench.run.working import Working
from benchbench.storage.files import write_record


def said(until: str, capfd: pytest.CaptureFixture[str]) -> str:
    """What is printed until a text is there."""
    heard, limit = "", time.monotonic() + 30
    while until not in heard and time.monotonic() < limit:
        heard += capfd.readouterr().err
        time.sleep(0.01)
    return heard


def test_a_pipe_hears_of_what_takes_long_only(
    capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    with Working("quick"):
        pass
    assert capfd.readouterr() == ("", "")
    monkeypatch.setattr(working, "SILENT_S", 0.01)
    with Working("reading") as hear:
        assert said("reading", capfd) == "benchbench: reading\n"
        hear("writing")
        assert said("writing", capfd) == "benchbench: writing\n", "each thing once"
    assert capfd.readouterr() == ("", "")


def test_commands_tell_what_they_do(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a pipe, on stderr; what they write to stdout stays clean."""
    monkeypatch.setattr(working, "SILENT_S", 1e-4)
    for number in range(100):
        write_record(tmp_path / "results" / str(number), row(str(number)))
    for arguments in (("table", "results", "--format", "csv"), ("report", "results"), ("bundle", "results")):
        done = told(tmp_path, *arguments)
        assert done.returncode == 0 and "benchbench: reading runs\n" in done.stderr
        assert "benchbench:" not in done.stdout


@pytest.mark.parametrize("columns", [80, 120])
def test_a_terminal_has_one_line_of_which_nothing_is_left(
    columns: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A text longer than the terminal is wide stays one line; the cursor ends where it began."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", str(columns))
    with os.fdopen(theirs, "w") as terminal:
        monkeypatch.setattr(sys, "stderr", terminal)
        with Working("reading runs") as hear:
            hear("verifying " + "a_long_name " * 20)
            time.sleep(0.3)
        terminal.write("done\n")
        terminal.flush()
        heard = listen(ours, "done")
    os.close(ours)
    plain = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", heard)
    shown = [line for part in plain.splitlines() for line in part.split("\r")]
    assert any("verifying a_long_name" in line and "\N{HORIZONTAL ELLIPSIS}" in line for line in shown)
    assert max(map(len, shown)) <= columns
    assert "done" in shown[-1] and heard.count("\n") <= 2, (
        "the end of the line, which is taken back, and that of done"
    )
    assert "\x1b[1A\x1b[2K" in heard
