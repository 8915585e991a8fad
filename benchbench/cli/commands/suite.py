"""`benchbench suite [NAME] [OVERRIDE ...]`: all tasks of a suite, and a summary."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from benchbench.cli.arguments import Parser

if TYPE_CHECKING:
    from benchbench.cli.commands import Sweep

EPILOG = """Short for a sweep (-m) over the seeds of a family of tasks, or over several scenarios, with everything a sweep can do: it goes
on where it stopped, and
takes any overrides and options. At its end it says how many tasks are certified, what that cost, how good the plans are and why
the rest is not certified, and writes that beside the table. Without a name it lists the suites there are.

examples
  benchbench suite handover100
  benchbench suite handover100 --quick dynamics=rk4 strategy=enumeration
  benchbench suite race50 hydra/launcher=dask hydra.launcher.scheduler=tcp://host:8786
"""


def run(arguments: Sequence[str]) -> int | Sweep:
    """Return the sweep it is short for, or list the suites; raises BadInput."""
    from benchbench.cli.commands import Sweep
    from benchbench.cli.suite_summary import conclude
    from benchbench.run.suites import suite

    asked, more = parser().parse_known_args(arguments)
    own = asked.config_dir
    if asked.name is None:
        print("\n".join(_listed(own)))
        return 0
    name, chosen = suite(asked.name, own)
    typed = [text for text in more if not text.startswith("-")]
    options = [text for text in more if text.startswith("-")] + (["--config-dir", own] if own else [])
    told = ["-m", *options, *chosen.overrides(typed, asked.quick)]
    return Sweep(told, partial(conclude, name, chosen, asked.quick))


def _listed(own: str | None) -> list[str]:
    from benchbench.run.suites import suite, suites

    found = {name: suite(str(path)) for name, path in suites(own).items()}
    width = max(map(len, found), default=0)
    return [
        f"{name:<{width}}  version {one.version}, {one.count(False)} tasks: {one.title}"
        for name, (_, one) in found.items()
    ]


def parser() -> Parser:
    """Return the arguments it takes."""
    takes = Parser("suite", "Run a method on the tasks of a suite.", EPILOG, overrides=True)
    takes.add_argument("name", nargs="?", metavar="NAME", help="a suite, or the path of a YAML file with one")
    takes.add_argument("--quick", action="store_true", help="a tenth of the tasks, the first ones")
    takes.add_argument(
        "--config-dir", metavar="DIR", help="a folder of your own configuration, suite/NAME.yaml in it"
    )
    return takes  # fmt: skip
