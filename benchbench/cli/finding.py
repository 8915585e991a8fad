"""Which stored run is meant."""

from __future__ import annotations

from pathlib import Path

from benchbench.ground.errors import BadInput
from benchbench.storage.files import RECORD

RESULTS = Path("results")


def run_folder(given: str) -> Path:
    """Return the folder of a run: given, or a file in it, or the `run_id` of a run below ./results; raises BadInput."""
    path = Path(given)
    folder = path.parent if path.is_file() else path
    if (folder / RECORD).is_file():
        return folder
    if not path.exists() and RESULTS.is_dir() and (named := _named(given)):
        return named
    problem = f"has no {RECORD}" if path.exists() else "does not exist"
    raise BadInput(given, problem, f"a run's folder, a file in it, or a run_id below {RESULTS}")


def _named(run_id: str) -> Path | None:
    from benchbench.storage.runs import stored

    return next((run.folder for run in reversed(stored(RESULTS)) if run.name == run_id), None)
