"""What the program says without having run anything: the usage and complaints."""

from __future__ import annotations

import os
import sys
import textwrap
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

USAGE = """BenchBench plans a flight, certifies the plan, stores it and shows it.

  benchbench +scenario=NAME [CHOICE=NAME ...] [FIELD=VALUE ...]      one run
  benchbench -m +scenario=A,B FIELD=V1,V2 ...               all combinations
  benchbench COMMAND ...                            one of those below

or python -m benchbench, which is the same.

Commands (benchbench COMMAND --help explains one, with examples)
{commands}

Choices
{choices}

Fields: every number and option of a choice, and of the run; for example
  scenario.kappa_init=5 scenario.intervals=150 dynamics.inputs=averaged
  A field that the YAML leaves out takes a plus sign: +scenario.start.y=0.3
  --cfg job with the choices shows them all.

Own YAML   --config-dir DIR with DIR/scenario/NAME.yaml, DIR/vehicle/NAME.yaml
Options    --version, --traceback (where an error came from), --hydra-help
Exit code  0 all plans certified, 1 a run ended without a certified plan,
           2 bad input, 130 interrupted"""


def usage(commands: Mapping[str, str], choices: Mapping[str, Sequence[str]]) -> str:
    """Return the help text: how each command is called and what it does, and the names to choose from, by family."""
    listed = {
        f"{'+' if family == 'scenario' else ''}{family}": ", ".join(names)
        for family, names in choices.items()
    }
    return USAGE.format(
        commands=_columns({name.removeprefix("benchbench "): text for name, text in commands.items()}),
        choices=_columns(listed),
    )


def _columns(rows: Mapping[str, str]) -> str:
    """Two columns on 80, the second folded."""
    from rich.console import Console
    from rich.table import Table

    grid = Table.grid(padding=(0, 2))
    grid.add_column(no_wrap=True)
    for name, text in rows.items():
        grid.add_row(f"  {name}", text)
    console = Console(width=80, color_system=None, highlight=False)
    with console.capture() as captured:
        console.print(grid)
    return "\n".join(line.rstrip() for line in captured.get().splitlines())


def complain(kind: str, text: str, trace: str = "", console: Console | None = None) -> None:
    """Print one message on stderr, below the traceback that led to it, if one is given.

    console: that of a live display, above which it has to stand.
    """
    if console is None and not sys.stderr.isatty() and "FORCE_COLOR" not in os.environ:  # sooner than by Rich
        lines = (f"  {line}" for line in text.splitlines())
        print(f"{trace}benchbench: {kind}", *lines, sep="\n", file=sys.stderr)
        return
    from rich.console import Console
    from rich.text import Text

    console = console or Console(stderr=True, highlight=False)
    if trace:
        console.print(Text(trace), soft_wrap=True, end="")
    console.print(Text("benchbench: ") + Text(kind, "bold red"), soft_wrap=True)
    for line in text.splitlines():
        console.print(Text(_indented(line, console)), soft_wrap=True)


def _indented(line: str, console: Console) -> str:
    """A line of a message, on a terminal wrapped at words."""
    if not console.is_terminal:
        return f"  {line}"
    return textwrap.fill(
        line,
        console.width,
        initial_indent="  ",
        subsequent_indent="  ",
        break_long_words=False,
        break_on_hyphens=False,
    )
