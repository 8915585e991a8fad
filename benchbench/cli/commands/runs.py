"""`benchbench runs [DIR]`: list, remove and merge runs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from benchbench.cli.arguments import Parser
from benchbench.ground.errors import BadInput
from benchbench.run.fitting import fitted, on_terminal, width

if TYPE_CHECKING:
    from benchbench.storage.runs import StoredRun

EXAMPLES = """examples
  benchbench runs                                        the runs below results
  benchbench runs results --status timeout               those of one status
  benchbench runs results --remove RUN_ID                its folder and its row
  benchbench runs results --remove-orphans               rows whose folder was deleted
  benchbench runs all --merge results ../other/results   copy the runs of other folders into one
"""


GONE = "its folder is gone"


def run(arguments: Sequence[str]) -> int:
    """Do what is asked and say what was done; raises BadInput."""
    from benchbench.storage.runs import merge, remove, stored

    asked = parser().parse_args(arguments)
    if asked.merge:
        made = merge(asked.folder, asked.merge)
        print(f"{len(made)} runs copied into {asked.folder}")
        return 0
    orphans = [run.name for run in stored(asked.folder) if run.folder is None] if asked.remove_orphans else []
    if asked.remove or asked.remove_orphans:
        for gone in remove(asked.folder, [*asked.remove, *orphans]):
            print(f"removed {_line(gone)}")
        return 0
    runs = [run for run in stored(asked.folder) if asked.status in (None, run.record["status"])]
    _list(runs)
    lost = sum(found.folder is None for found in runs)
    print(f"{len(runs)} runs" + (f", {lost} without a folder (--remove-orphans)" if lost else ""))
    return 0


def _list(runs: Sequence[StoredRun]) -> None:
    """A line each; on a terminal in columns, without the names of runs where those do not fit, since their folders name them, too."""
    if not on_terminal():
        for found in runs:
            print(_line(found))
        return
    cells = [(found.name, *_told(found)[:3], str(found.folder or f"{found.name}: {GONE}")) for found in runs]
    widths = [max((len(row[i]) for row in cells), default=0) for i in range(4)]
    longest = sum(widths) + 8 + max((len(row[4]) for row in cells), default=0)
    first = 0 if longest <= width() else 1
    indent = sum(w + 2 for w in widths[first:])
    for row in cells:
        aligned = (f"{text:<{w}}  " for text, w in zip(row[first:4], widths[first:], strict=True))
        print(fitted("".join(aligned) + row[4], indent))


def _line(run: StoredRun) -> str:
    scenario, status, time, place = _told(run)
    return f"{run.name}  {scenario}  {status}{f'  {time}' if time else ''}  {place or GONE}"


def _told(run: StoredRun) -> tuple[str, str, str, str]:
    """Scenario, status, travel time and folder."""
    time = run.record["travel_time_s"]
    told = "" if time is None else f"{time:.4f} s"
    return (
        run.record["scenario"] or "",
        run.record["status"] or "",
        told,
        str(run.folder or ""),
    )


def parser() -> Parser:
    """Return the arguments it takes."""
    from benchbench.storage.status import Status

    takes = Parser("runs", "List, remove and merge the runs of a folder of results.", EXAMPLES)
    takes.add_argument(
        "folder", nargs="?", type=Path, default=Path("results"), metavar="DIR", help="default: results"
    )
    takes.add_argument("--status", type=_status, help="list those only: " + ", ".join(Status))
    takes.add_argument("--remove", nargs="+", default=[], metavar="RUN", help="run_ids, or folders of runs")
    takes.add_argument("--remove-orphans", action="store_true", help="remove rows whose folder was deleted")
    takes.add_argument(
        "--merge", nargs="+", type=Path, default=[], metavar="OTHER", help="folders of results"
    )
    return takes


def _status(text: str) -> str:
    from benchbench.storage.status import Status

    if text not in list(Status):
        raise BadInput("--status", f"there is no status '{text}'", ", ".join(Status))
    return text
