"""`benchbench show RUN ...`: the summary of a stored run again."""

from __future__ import annotations

from collections.abc import Sequence

from benchbench.cli.arguments import Parser

EXAMPLES = """examples
  benchbench show results/runs/DATE/TIME         the folder of a run, or a file in it
  benchbench show RUN_ID                         as benchbench runs lists it, below results
  benchbench show results/sweeps/DATE/TIME/*     several
"""


def run(arguments: Sequence[str]) -> int:
    """Print the summaries; raises BadInput for what is no run."""
    from benchbench.cli.finding import run_folder
    from benchbench.run import summary
    from benchbench.run.verbs import load

    for folder in [run_folder(given) for given in parser().parse_args(arguments).run]:
        found = load(folder)
        files = {path.name: path for path in sorted(folder.iterdir()) if path.is_file()}
        summary.show(found.record, files)
    return 0


def parser() -> Parser:
    """Return the arguments it takes."""
    takes = Parser("show", "Say again what a run said when it ended.", EXAMPLES)
    takes.add_argument("run", nargs="+", metavar="RUN", help="a run's folder, a file in it, or a run_id")
    return takes
