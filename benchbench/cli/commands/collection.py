"""`benchbench collection DIR [OVERRIDE ...]`: short for `-m +scenario=mpcc_file` with every problem file in a folder."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from benchbench.errors import BadInput

USAGE = "benchbench collection DIR [OVERRIDE ...], see docs/mpccs.md"
KINDS = ("*.json", "*.json.gz")


def run(arguments: Sequence[str]) -> int | list[str]:
    """Return what it is short for, or the exit code of its help; raises BadInput."""
    if not arguments or arguments[0] in ("-h", "--help"):
        print(USAGE)
        return 0 if arguments else 2
    folder = Path(arguments[0])
    files = sorted({path for kind in KINDS for path in folder.glob(kind) if path.name != "manifest.json"})
    if not files:
        raise BadInput(str(folder), "has no problem file", "a folder with .json or .json.gz files")
    return ["-m", "+scenario=mpcc_file", f"scenario.path={','.join(map(_quoted, files))}", *arguments[1:]]


def _quoted(path: Path) -> str:
    """The absolute path, so that Hydra takes it as one text whatever is in it."""
    text = str(path.resolve()).replace("\\", "\\\\").replace("'", "\\'")
    return f"'{text}'"
