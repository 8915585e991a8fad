"""`benchbench bundle DIR`: the runs of a folder as one archive for others."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from benchbench.cli.arguments import Parser
from benchbench.ground.errors import BadInput
from benchbench.run.telling import complain

EPILOG = """The archive is a zip file with record, configuration, plan and overrides of each run, the versions of everything that is
installed, and the SHA-256 of each file. `benchbench table` and `benchbench report` take it in place of a folder: it is verified, and
its plans are certified anew. Configurations may name folders of yours. docs/sharing.md says more.

examples
  benchbench bundle results                                           results.zip
  benchbench bundle results --output laptop.zip --machine laptop
  benchbench table laptop.zip server.zip                              with a column for the machine
  benchbench report laptop.zip server.zip --leaderboard               rows are methods, columns are tasks
"""


def run(arguments: Sequence[str]) -> int:
    """Write the bundle and say what is in it; raises BadInput."""
    from benchbench.run.working import Working
    from benchbench.storage.bundle import SUFFIX, pack

    asked = parser().parse_args(arguments)
    output = asked.output or Path(f"{asked.folder.resolve().name or 'results'}{SUFFIX}")
    if output.suffix != SUFFIX:
        raise BadInput("--output", f"'{output.name}' was given", f"a name that ends in {SUFFIX}")
    with Working("reading runs") as hear:
        manifest, problems = pack(asked.folder, output, asked.machine, hear)
    for path, problem in problems.items():
        complain("left out", f"{path}: {problem}")
    size = output.stat().st_size / 1e6
    print(
        f"{manifest.runs} runs, {len(manifest.files)} files of '{manifest.machine}' in {output} ({size:.1f} MB)"
    )
    return 0


def parser() -> Parser:
    """Return the arguments it takes."""
    takes = Parser("bundle", "Put the runs below a folder into one archive that others can open.", EPILOG)
    takes.add_argument("folder", type=Path, metavar="DIR", help="a folder with results")
    takes.add_argument(
        "--output", type=Path, metavar="FILE", help="default: the folder's name with .zip, here"
    )
    takes.add_argument("--machine", metavar="NAME", help="what to call this machine (default: its processor)")
    return takes
