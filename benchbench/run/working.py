"""What a command is at while one waits for it: a line on a terminal, plain lines in a pipe once it takes more than two seconds."""

from __future__ import annotations

import sys
from threading import Event, Thread
from types import TracebackType
from typing import Self, final

from rich.console import Console
from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.table import Column

SILENT_S, LONGEST_S = 2.0, 30.0
"""Seconds without a word at first, and at most: the pauses between lines in a pipe double."""


@final
class Working:
    """A context that is called with what is done now, in a few words; nothing of it is left on a terminal, nor on stdout."""

    def __init__(self, what: str, live: bool = True) -> None:
        """Begin with what the command does as a whole; live: show a line on a terminal, where nothing else does."""
        self._text, self._told = what, ""
        self._console = Console(stderr=True, highlight=False)
        self._live, self._piped = live and self._console.is_terminal, not self._console.is_terminal
        self._bar = Progress(
            SpinnerColumn("line"),
            TextColumn("{task.description}", markup=False, table_column=Column(no_wrap=True, overflow="ellipsis")),
            TimeElapsedColumn(), console=self._console, transient=True, redirect_stdout=False, redirect_stderr=False,
        )  # fmt: skip
        self._task = self._bar.add_task(what)
        self._over = Event()
        self._thread = Thread(target=self._lines, daemon=True)

    def __call__(self, text: str) -> None:
        """Say what is done now."""
        self._text = text
        if self._live:
            self._bar.update(self._task, description=text)

    def __enter__(self) -> Self:
        """Start showing."""
        if self._live:
            self._bar.start()
        if self._piped:
            self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Remove the line."""
        self._over.set()
        if self._live:
            self._bar.stop()
        if self._piped:
            self._thread.join()

    def _lines(self) -> None:
        pause, file = SILENT_S, sys.stderr
        while not self._over.wait(pause):
            if self._text != self._told:
                self._told = self._text
                print(f"benchbench: {self._told}", file=file, flush=True)
                pause = min(2 * pause, LONGEST_S)
