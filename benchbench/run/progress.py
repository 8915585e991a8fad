"""Live progress of a run on a terminal: one line with the stage, iteration, travel time and violation."""

from __future__ import annotations

from collections.abc import Callable
from types import TracebackType
from typing import Self, final

from rich.console import Console
from rich.progress import Progress as Bar
from rich.progress import SpinnerColumn, TextColumn, TimeElapsedColumn

from benchbench.ground.arrays import Array
from benchbench.nlp.ledger import Milestone, Watch
from benchbench.nlp.solver import Progress


@final
class LiveLine(Watch):
    """A context that shows the running solve on stderr; silent when stderr is not a terminal."""

    def __init__(self, told: Callable[[Milestone], None] | None = None) -> None:
        """Set up the line without showing it; `told` hears of each solve that ended."""
        self._told = told
        console = Console(stderr=True)
        self._bar = Bar(
            SpinnerColumn("line"), TextColumn("{task.description}", markup=False), TimeElapsedColumn(),
            console=console, transient=True,
        )  # fmt: skip
        self._task = self._bar.add_task("preparing")
        self._seen = console.is_terminal

    def __enter__(self) -> Self:
        """Start showing."""
        if self._seen:
            self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Remove the line."""
        if self._seen:
            self._bar.stop()

    def step(self, step: Milestone) -> None:
        """Hand it on."""
        if self._told:
            self._told(step)

    def stage(self, name: str, shape: tuple[int, int] | None) -> Progress | None:
        """Name the stage; no callback at all when nobody looks."""
        if not self._seen:
            return None
        self._bar.update(self._task, description=name)

        def show(iteration: int, x: Array, violation: float) -> None:
            text = f"{name:<13}  iter {iteration:<4d}"
            if shape is not None:
                text += f"  travel time {x[shape[0] : shape[0] + shape[1]].sum():.4f} s"
            self._bar.update(self._task, description=f"{text}  violation {violation:.1e}")

        return show
