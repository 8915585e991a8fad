"""`benchbench collection DIR [OVERRIDE ...]`: all MPCC files of a folder as a sweep."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from benchbench.cli.arguments import Parser
from benchbench.ground.errors import BadInput

KINDS = ("*.json", "*.json.gz")

EPILOG = """Short for -m +scenario=mpcc_file with every .json and .json.gz file of the folder; docs/mpccs.md says what is in them.

examples
  benchbench collection problems
  benchbench collection problems relaxation=scholtes,lin_fukushima strategy=continuation
"""


def run(arguments: Sequence[str]) -> list[str]:
    """Return what it is short for; raises BadInput."""
    asked, more = parser().parse_known_args(arguments)
    folder = asked.folder
    files = sorted({path for kind in KINDS for path in folder.glob(kind) if path.name != "manifest.json"})
    if not files:
        raise BadInput(str(folder), "has no problem file", "a folder with .json or .json.gz files")
    return ["-m", "+scenario=mpcc_file", f"scenario.path={','.join(map(_quoted, files))}", *more]


def parser() -> Parser:
    """Return the arguments it takes."""
    takes = Parser("collection", "Solve all problem files of a folder, as a sweep.", EPILOG, overrides=True)
    takes.add_argument("folder", type=Path, metavar="DIR", help="a folder with problem files")
    return takes


def _quoted(path: Path) -> str:
    """The absolute path, so that Hydra takes it as one text whatever is in it."""
    text = str(path.resolve()).replace("\\", "\\\\").replace("'", "\\'")
    return f"'{text}'"
