"""What a sweep shows while it runs: a line per run, and on a terminal a bar below them."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Collection, Sequence
from types import TracebackType
from typing import Self, final

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from benchbench.run.execution import Ended
from benchbench.run.sweep_line import show_line
from benchbench.run.telling import complain


@final
class Display:
    """A context that shows the ends of runs."""

    def __init__(self, runs: int, traced: bool, shared: Collection[str] = ()) -> None:
        """Take the number of runs, whether to show where errors came from, and overrides not worth repeating."""
        console = Console(stderr=True, highlight=False)
        self._shared = frozenset(shared)
        self._runs, self._traced, self._failures, self._certified = runs, traced, Counter[str](), 0
        self._bar = Progress(
            BarColumn(20), MofNCompleteColumn(), TextColumn("{task.description}", markup=False),
            TimeRemainingColumn(), console=console, transient=True, redirect_stdout=False, redirect_stderr=False,
        )  # fmt: skip
        self._waits = False
        self._task = self._bar.add_task("runs", total=runs)
        self._seen = console.is_terminal
        # Past the live display a line would be glued to the bar that stands there.
        self._errors = console if self._seen else None
        self._rows = console if self._seen and sys.stdout.isatty() else None

    def __enter__(self) -> Self:
        """Start showing."""
        if self._seen:
            self._bar.start()
        elif self._runs > 1:
            print(f"{self._runs} runs to do", flush=True)  # the first one may take long
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Remove the bar."""
        if self._seen:
            self._bar.stop()

    def skipped(self) -> None:
        """Count a run that need not run."""
        self._bar.update(self._task, advance=1)

    def waits(self, runs: int) -> None:
        """Say once that the rest is at work elsewhere."""
        if not self._waits:
            note = f"waiting for {runs} runs that another sweep into this folder is at"
            if self._rows:
                self._rows.print(note, soft_wrap=True)
            else:
                print(note, flush=True)
        self._waits = True

    def ended(self, number: int, overrides: Sequence[str], end: Ended) -> None:
        """Show how a run ended."""
        combination = " ".join(text for text in overrides if text not in self._shared)
        for complaint in end.complaints:
            where = f"{complaint.kind} (run {number}: {combination})"
            complain(where, complaint.text, complaint.trace if self._traced else "", self._errors)
        if end.record is not None and not end.complaints:
            show_line(number, end.record, combination, self._rows)
        status = str(end.record["status"]) if end.record else "bad input"
        self._certified += status == "certified"
        self._failures[status] += status != "certified"
        counts = ", ".join(f"{count} {name}" for name, count in self._failures.most_common() if count)
        text = f"{self._certified} certified" + (f", {counts}" if counts else "")
        self._bar.update(self._task, advance=1, description=text)
