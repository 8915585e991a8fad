"""What the program says without having run anything: the usage and complaints."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence

from rich.console import Console
from rich.table import Table
from rich.text import Text

USAGE = """BenchBench plans a flight, certifies the plan, stores it and shows it.

  benchbench +scenario=NAME [CHOICE=NAME ...] [FIELD=VALUE ...]      one run
  benchbench -m +scenario=A,B FIELD=V1,V2 ...               all combinations
  benchbench suite [NAME ...]             all tasks of a suite, and a summary
  benchbench plugins [FAMILY=NAME]        what there is, and whether it works
  benchbench table [DIR ...]              all runs as a table: text, CSV, ...
  benchbench report DIR ...               all runs as one HTML page
  benchbench draw DIR ...                 pictures of the plans of a sweep
  benchbench best DIR ...                 keep the best certified plans

or python -m benchbench, which is the same.

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


def usage(choices: Mapping[str, Sequence[str]]) -> str:
    """Return the help text; `choices` are the names to choose from, by family."""
    grid = Table.grid(padding=(0, 2))
    for family, names in choices.items():
        grid.add_row(f"  {'+' if family == 'scenario' else ''}{family}", ", ".join(names))
    console = Console(width=80, color_system=None)
    with console.capture() as captured:
        console.print(grid)
    listed = "\n".join(line.rstrip() for line in captured.get().splitlines())
    return USAGE.format(choices=listed)


def complain(kind: str, text: str, trace: str = "") -> None:
    """Print one message on stderr, below the traceback that led to it, if one is given."""
    sys.stderr.write(trace)
    console = Console(stderr=True, highlight=False)
    console.print(Text("benchbench: ") + Text(kind, "bold red"), soft_wrap=True)
    for line in text.splitlines():
        console.print(Text(f"  {line}"), soft_wrap=True)
