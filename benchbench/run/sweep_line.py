"""What a sweep says of each run: one line."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rich.console import Console
from rich.text import Text

from benchbench.run.summary import flies, new_best
from benchbench.run.wording import above, number


def show_line(run: int, record: Mapping[str, Any], combination: str, console: Console | None = None) -> None:
    """Print one run of a sweep on one line; on a terminal too narrow for its overrides, their values alone; console: as of `complain`."""
    console = console or Console(highlight=False)
    verdict = "certified" if record["certified"] else f"NOT: {record['status']}"
    if record["certified"] and record["b_stationary"] == "no":
        verdict = "not stationary"
    timed = flies(record) or record["objective"] is None
    found = number(record["travel_time_s"], ".4f", "s") if timed else f"f = {record['objective']:.6g}"
    line = Text(f"{run:>4}  ") + Text(f"{verdict:<20}", "green" if record["certified"] else "red")
    gap = "" if record["gap_percent"] is None else above(record["gap_percent"])
    flown = (
        "" if record["flights"] is None else f"{record['flights_succeeded']}/{record['flights']} flights  "
    )
    line += Text(f"  {found:>{9 if timed else 16}}  {gap:>10}  ", "bold green" if new_best(record) else "")
    line += Text(flown)
    if console.is_terminal:
        if line.cell_len + len(combination) > console.width:
            combination = " ".join(text.partition("=")[2] or text for text in combination.split())
        line += Text(combination)
        line.truncate(console.width, overflow="ellipsis")
    else:
        line += Text(combination)
    console.print(line, soft_wrap=True)


def count(certified: int, runs: int) -> None:
    """Print how a sweep went."""
    Console(highlight=False).print(f"{certified} of {runs} runs certified")
