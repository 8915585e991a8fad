"""`benchbench regress [OVERRIDE ...]`: has anything become worse?"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from benchbench.cli.arguments import Parser
from benchbench.ground.errors import BadInput, Unavailable
from benchbench.run.fitting import fitted

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from benchbench.sweep.regression.compare import Change
    from benchbench.sweep.regression.matrix import Matrix
    from benchbench.sweep.regression.measure import Measured

EXAMPLES = """examples
  benchbench regress                    against references/baseline; exit code 1 if anything became worse
  benchbench regress --update           measure and store a new baseline
  benchbench regress solver=uno         overrides apply to every case: is this choice better or worse?
  benchbench regress --baseline DIR     your own: DIR holds a matrix.yaml like that of references/baseline
"""

WIDE = 110
"""Columns that the table of changes needs."""
STYLE = {"same": "", "better": "green", "WORSE": "bold red"}


def run(arguments: Sequence[str]) -> int:
    """Return 0 if nothing became worse, 1 otherwise; raises BadInput."""
    from benchbench.sweep.regression import baseline
    from benchbench.sweep.regression.compare import compare, unavailable
    from benchbench.sweep.regression.matrix import Matrix

    asked = parser().parse_args(arguments)
    if os.environ.get("OMP_NUM_THREADS") != "1":  # libraries read it when they are loaded
        command = [sys.executable, "-m", "benchbench", "regress", *arguments]
        return subprocess.run(command, env={**os.environ, "OMP_NUM_THREADS": "1"}, check=False).returncode
    folder = Path(asked.baseline)
    matrix = Matrix.load(folder)
    made, old = ({}, {}) if asked.update else baseline.load(folder)
    _check_names(matrix, old, asked.update)
    entries, missing = _measure_all(matrix, asked.overrides)
    if asked.update:
        if missing:
            raise Unavailable("; ".join(missing.values()))
        print(f"baseline of {len(entries)} cases written to {baseline.save(folder, entries)}")
        return 0
    changes = [c for name, now in entries.items() for c in compare(name, old[name], now, matrix.gates)]
    changes += [unavailable(name, old[name], why) for name, why in missing.items()]
    return _report(
        changes, f"against {made.get('git_commit') or made.get('benchbench_version')} on {made.get('cpu')}"
    )


def parser() -> Parser:
    """Return the arguments it takes."""
    takes = Parser("regress", "Has anything become worse? See docs/regression.md.", EXAMPLES)
    takes.add_argument(
        "--baseline",
        default="references/baseline",
        metavar="DIR",
        help="folder of matrix.yaml and baseline.json",
    )
    takes.add_argument("--update", action="store_true", help="measure and store a new baseline")
    takes.add_argument(
        "overrides", nargs="*", metavar="OVERRIDE", help="overrides for every case, as in the main command"
    )
    return takes


def _check_names(matrix: Matrix, old: dict[str, Measured], update: bool) -> None:
    if not update and set(matrix.cases) != set(old):
        differ = ", ".join(sorted(set(matrix.cases) ^ set(old)))
        raise BadInput(
            "--baseline", f"matrix.yaml and baseline.json differ in {differ}", "--update to store it anew"
        )


def _measure_all(matrix: Matrix, overrides: Sequence[str]) -> tuple[dict[str, Measured], dict[str, str]]:
    """What each case gave, and why those that need something that is not installed gave nothing."""
    from benchbench.nlp.reference import Reference
    from benchbench.run.working import Working
    from benchbench.sweep.regression.measure import measure

    entries, missing = {}, {}
    with Working("the reference solve") as hear:
        reference = Reference()
        reference.cpu_s()
        for number, (name, case) in enumerate(matrix.cases.items(), 1):
            hear(f"case {number} of {len(matrix.cases)}: {name}")
            try:
                entries[name] = measure([*case, *matrix.common, *overrides], matrix.repeats, reference)
            except Unavailable as error:
                if not any(text.startswith("flights=") for text in case):
                    raise
                missing[name] = str(error)
    return entries, missing


def _table(changes: Sequence[Change], title: str) -> Table:
    from rich.table import Table

    told = Table(title=title)
    for heading in ("case", "what", "was", "now", "change", "verdict", "gate"):
        told.add_column(heading, overflow="fold")
    for c in changes:
        told.add_row(c.case, c.what, c.was, c.now, _said(c), c.verdict, c.note, style=STYLE[c.verdict])
    return told


def _list(changes: Sequence[Change], title: str, console: Console) -> None:
    """The same for a narrow terminal: a line for each number below its case, and the gate of what is not the same."""
    print(title)
    widths = [max((len(getattr(c, name)) for c in changes), default=0) for name in ("what", "was", "now")]
    for case in dict.fromkeys(c.case for c in changes):
        print(case)
        for c in (c for c in changes if c.case == case):
            cells = "  ".join(f"{text:<{w}}" for text, w in zip((c.what, c.was, c.now), widths, strict=True))
            line = f"  {cells}  {_said(c):>8}  {c.verdict}"
            console.print(line, style=STYLE[c.verdict], highlight=False, markup=False, soft_wrap=True)
            if c.verdict != "same":
                print(fitted(f"    {c.note}", 4))


def _said(change: Change) -> str:
    return "" if change.change is None else f"{change.change:+.1%}"


def _report(changes: Sequence[Change], title: str) -> int:
    from rich.console import Console

    worse = [c for c in changes if c.verdict == "WORSE"]
    console = Console(width=None if sys.stdout.isatty() else 140)
    shown = [c for c in changes if c.moved or c.what == "solve / reference"]
    if console.width >= WIDE:
        console.print(_table(shown, title))
    else:
        _list(shown, title, console)
    counts = {verdict: sum(c.verdict == verdict for c in changes) for verdict in STYLE}
    within = sum(c.moved for c in changes if c.verdict == "same")
    console.print(
        f"{counts['same'] - within} numbers the same, {within} changed within their gates, "
        f"{counts['better']} better, {counts['WORSE']} worse",
        highlight=False, soft_wrap=True,
    )  # fmt: skip
    for c in worse:
        where = f"{c.case}: {c.what} was {c.was}, is {c.now}"
        console.print(
            where + (f" ({c.change:+.1%})" if c.change is not None else ""), highlight=False, soft_wrap=True
        )
    return 1 if worse else 0
