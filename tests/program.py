"""The program in tests: `told` calls its entry in this process, `program` starts a real one, `on_terminal` shows it one.

A process costs a second before it does anything, so what it says is asked of `told`. Real ones are for signals,
terminals, exits, kills, packaging, pipes and the commands of the README.
"""

from __future__ import annotations

import io
import json
import logging
import os
import signal
import subprocess
import sys
import time
import warnings
from collections.abc import Iterator, Mapping
from contextlib import chdir, contextmanager, redirect_stderr, redirect_stdout
from multiprocessing import resource_tracker
from pathlib import Path
from typing import Any
from unittest.mock import patch

from hydra.core.hydra_config import HydraConfig

from benchbench.cli.application import start

COMMAND = (sys.executable, "-m", "benchbench")
ENVIRONMENT = {"OMP_NUM_THREADS": "1"}

Done = subprocess.CompletedProcess[str]


def program(folder: Path, *arguments: str, **environment: str) -> Done:
    """Run the program in a folder, both outputs on pipes."""
    return subprocess.run(
        [*COMMAND, *arguments], cwd=folder, env={**os.environ, **ENVIRONMENT, **environment},
        capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip


def told(folder: Path, *arguments: str, **environment: str) -> Done:
    """Do the same in this process: what `main` calls, in the folder, with both outputs caught."""
    out, err = (io.TextIOWrapper(io.BytesIO(), "utf-8", write_through=True) for _ in range(2))
    with _alone(environment), chdir(folder), redirect_stdout(out), redirect_stderr(err):
        try:
            code = start(arguments)
        except SystemExit as left:
            code = left.code if isinstance(left.code, int) else int(left.code is not None)
    texts = [stream.buffer.getvalue().decode() for stream in (out, err)]
    return Done(arguments, code, *texts)


@contextmanager
def _alone(environment: Mapping[str, str]) -> Iterator[None]:
    """As in a process of its own: arguments, environment, search path, logging and Hydra's choices are put back."""
    root, own = logging.getLogger(), environment.get("PYTHONPATH", "").split(os.pathsep)
    added = [entry for entry in own if entry and entry not in sys.path]
    handlers, level, chosen = root.handlers[:], root.level, HydraConfig.instance().cfg
    values = {**ENVIRONMENT, "COLUMNS": "80", **environment}
    resource_tracker.ensure_running()  # lives on in the folder where it was started
    try:
        with (
            patch.dict(os.environ, values),
            patch.object(sys, "argv", ["benchbench"]),
            patch.object(sys, "path", [*added, *sys.path]),
            warnings.catch_warnings(),
        ):
            _as_python_warns()
            yield
    finally:
        root.handlers[:], HydraConfig.instance().cfg = handlers, chosen
        root.setLevel(level)
        for name, module in list(sys.modules.items()):  # the next test may have another of this name
            if str(getattr(module, "__file__", None)).startswith(tuple(added)):
                del sys.modules[name]


def _as_python_warns() -> None:
    """Warnings are printed and stop nothing, those for developers are not."""
    warnings.resetwarnings()
    for kind in (DeprecationWarning, PendingDeprecationWarning, ImportWarning, ResourceWarning):
        warnings.simplefilter("ignore", kind)
    warnings.showwarning = lambda *about: print(warnings.formatwarning(*about[:4]), end="", file=sys.stderr)


def records(folder: Path) -> list[dict[str, Any]]:
    return [json.loads(path.read_text()) for path in sorted(folder.rglob("record.json"))]


def assert_refused(done: Done, field: str, says: str = "") -> None:
    """Exit code 2 and one message of two lines: bad input, then the field."""
    assert done.returncode == 2, done.stderr
    first, second = done.stderr.splitlines()
    assert first == "benchbench: bad input"
    assert second.startswith(f"  {field}: ")
    assert says in second


@contextmanager
def on_terminal(
    folder: Path, *arguments: str, **environment: str
) -> Iterator[tuple[subprocess.Popen[bytes], int]]:
    """The program with both outputs on a pseudo-terminal of 80 columns; gives the process and our end."""
    import fcntl
    import pty
    import struct
    import termios

    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
    process = subprocess.Popen(
        [*COMMAND, *arguments], cwd=folder, stdin=theirs, stdout=theirs, stderr=theirs,
        env={**os.environ, **ENVIRONMENT, "TERM": "xterm", "NO_COLOR": "1", **environment},
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )  # fmt: skip
    os.close(theirs)
    try:
        yield process, ours
    finally:
        process.kill()
        process.wait()
        os.close(ours)


def listen(terminal: int, until: str = "", seconds: float = 120.0) -> str:
    """What the program prints, up to a text or to its end."""
    heard, limit = "", time.monotonic() + seconds
    while not (until and until in heard) and time.monotonic() < limit:
        try:
            heard += os.read(terminal, 65536).decode(errors="replace")
        except OSError:  # Linux: the other end is closed
            break
    return heard
