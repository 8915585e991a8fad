"""A run as Python and notebooks have it: the same whether it has just ended or was read from its folder."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, final

from rich.text import Text

from benchbench.certificate.certificate import Certificate
from benchbench.certificate.replay import Replay
from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput, BenchBenchError
from benchbench.ocp.model import Model
from benchbench.ocp.plan import Plan
from benchbench.ocp.scenario import Scenario
from benchbench.report.style import BAD, GOOD
from benchbench.run.summary import lines
from benchbench.storage.schema import Record

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NAME, TEXT = (f"text-align: left; vertical-align: top; white-space: {how};" for how in ("nowrap", "pre-line"))
"""How cells of the summary look, whatever the notebook does to tables."""


class Source(ABC):
    """Where the parts of a run are; each raises BadInput, or Unavailable, where it cannot be had."""

    @abstractmethod
    def plan(self) -> Plan | None:
        """Return the plan, None for a run that was no flight."""

    @abstractmethod
    def solution(self) -> dict[str, Array] | None:
        """Return the unknowns by name, None for a flight."""

    @abstractmethod
    def certificate(self) -> Certificate:
        """Return the judgement, check by check."""

    @abstractmethod
    def scene(self) -> tuple[Scenario, Model, Replay | None]:
        """Return what it takes to draw the plan of a flight."""

    @abstractmethod
    def save(self, folder: Path, table: Path) -> None:
        """Write the files into `folder` and the row below `table`."""


@final
@dataclass(frozen=True, eq=False, repr=False)
class RunView:
    """One run: `record` is its row of the table (docs/table.md), `config` the composed configuration as YAML.

    A notebook shows its verdict and numbers by itself.
    """

    record: Record
    config: str
    source: Source

    @property
    def certified(self) -> bool:
        """Whether the certificate accepted the plan, or the solution, when the run ended."""
        return self.record["certified"] is True

    @property
    def travel_time(self) -> float | None:
        """Travel time t_N in s, None without a plan."""
        time: float | None = self.record["travel_time_s"]
        return time

    @property
    def plan(self) -> Plan | None:
        """The plan; `run.plan.to_frame()` is its table. None where the problem was no flight.

        Raises BadInput where a stored flight has no recording that can be read, Unavailable without the package mcap.
        """
        return self.source.plan()

    @property
    def solution(self) -> dict[str, Array] | None:
        """The unknowns of a problem that was no flight, by name, each (rows, columns); None for a flight.

        Raises BadInput where a stored run has none that can be read.
        """
        return self.source.solution()

    @property
    def certificate(self) -> Certificate:
        """Every check with its value and limit.

        A stored run has only the verdict and the worst numbers, in its record: its plan is judged again by the limits
        of its configuration, without the residuals of the problem that gave it. Raises BadInput where that cannot be
        done, and for a stored MPCC.
        """
        return self.source.certificate()

    def draw(self) -> Figure:
        """Return the picture of the plan, plan.png, as a matplotlib figure; neither pyplot nor its settings play a part.

        Raises BadInput for a run without a plan.
        """
        from benchbench.report.caption import caption
        from benchbench.report.picture import figure

        plan, name = self.plan, self.record["scenario"]
        if plan is None:
            raise BadInput("draw", f"'{name}' is no flight, so there is no plan to draw", "a run of a flight")
        scenario, model, replay = self.source.scene()
        return figure(plan, scenario, model, replay, *caption(self.record))

    def save(self, folder: Path | str) -> Path:
        """Write what the program writes, and return the folder.

        config.yaml, record.json, plan.mcap and plan.png (for an MPCC solution.json) go into `folder`, the row into
        the table beside it, `folder/../table`; so `bb.runs(folder/..)` has it. What is there is replaced.
        Raises BadInput("output", ...) when the file system refuses.
        """
        folder = Path(folder)
        self.source.save(folder, folder.resolve().parent)
        return folder

    def __repr__(self) -> str:
        """One line: what, verdict, travel time or objective."""
        objective = self.record["objective"] if self.record["intervals"] is None else None
        found = "" if objective is None else f", objective {objective:.6g}"
        time = found if self.travel_time is None else f", {self.travel_time:.4f} s"
        return f"<{self.record['scenario']}: {'certified' if self.certified else 'NOT certified'}{time}>"

    def _repr_html_(self) -> str:
        rows = "".join(
            f'<tr><th style="{NAME}">{escape(name)}</th><td style="{TEXT}">{self._html(name, text)}</td></tr>'
            for name, text in lines(self.record)
        )
        return f"<table>{rows}</table>"

    def _repr_png_(self) -> bytes | None:
        """The picture, for front ends that show no HTML; None without one."""
        try:
            png: bytes = self.draw()._repr_png_()  # type: ignore[attr-defined]
        except BenchBenchError:
            return None
        return png

    def _html(self, name: str, text: Text | str) -> str:
        said = escape(text.plain if isinstance(text, Text) else text)
        if name != "verdict":
            return said
        first, _, more = said.partition("\n")
        rest = f"\n{more}" if more else ""
        return f'<b style="color: {GOOD if self.certified else BAD}">{first}</b>{rest}'
