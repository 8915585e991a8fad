"""A leaderboard as one static page: rows are methods, columns are tasks, each cell leads to its plan and command."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from benchbench.report.html.page import PlanView, environment, plotly_library, stamp


@dataclass(frozen=True)
class Entry:
    """The best certified plan of a method on a task, or its best solution of a problem that is no flight.

    anchor       its name within the page
    value        travel time in s of a plan, objective of a solution
    flies        whether it is a plan
    best         whether none on this task is faster, or has a lower objective
    above        how much slower than the fastest, or above the lowest, %
    command      overrides that plan it, "" where they were not kept
    plan         where its file lies, relative to the page
    plan_sha256  of that file
    facts        numbers and provenance in words
    config       its configuration, YAML
    view         the plan to look at, None where there is no room
    """

    anchor: str
    method: str
    task: str
    value: float
    flies: bool
    best: bool
    above: float
    command: str
    plan: str
    plan_sha256: str
    facts: Mapping[str, str]
    config: str
    view: PlanView | None = None

    @property
    def number(self) -> str:
        """Its value, without a unit."""
        return f"{self.value:.4f}" if self.flies else f"{self.value:.7g}"


@dataclass(frozen=True)
class Place:
    """A cell: its entry, or how often the method was tried there in vain and why."""

    entry: Entry | None = None
    tries: int = 0
    hint: str = ""


@dataclass(frozen=True)
class Board:
    """Everything the page shows.

    tasks     names of the columns, with the hash of what is asked
    rows      methods with a cell for each task, those that certified most tasks first
    unsolved  tasks without any certified plan
    said      what was judged anew, in one line
    sources   each place that runs came from: its path, its machine, how many runs, what it says it was made with
    left_out  runs without a plan that could be judged here: how many for each reason
    problems  files that could not be used
    """

    title: str
    tasks: Sequence[tuple[str, str]]
    rows: Sequence[tuple[str, Sequence[Place]]]
    unsolved: Sequence[str]
    said: str
    sources: Sequence[tuple[str, str, int, str]]
    left_out: Mapping[str, int]
    problems: Mapping[str, str] = field(default_factory=dict)

    @property
    def entries(self) -> list[Entry]:
        """All of them, task by task, the fastest first."""
        found = [place.entry for _, places in self.rows for place in places if place.entry]
        order = {name: i for i, (name, _) in enumerate(self.tasks)}
        return sorted(found, key=lambda one: (order[one.task], one.value))


def render(board: Board) -> str:
    """Return the page as one HTML document that refers to nothing but the files of its plans."""
    drawn = any(entry.view for entry in board.entries)
    template = environment().get_template("leaderboard.html")
    return template.render(board=board, plotly=plotly_library() if drawn else "", **stamp())
