"""One run on a worker of a cluster: a process of its own carries out what a local sweep would.

Dask's workers are daemonic and may not have multiprocessing children; a plain child process may.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import subprocess
import sys
import tempfile
from pathlib import Path

from hydra.core.config_search_path import ConfigSearchPath
from omegaconf import read_write

from benchbench.ground.errors import Crash
from benchbench.run.execution import Ended
from benchbench.sweep import processes
from benchbench.sweep.pool import run_all
from benchbench.sweep.task import Task

Files = dict[str, bytes]
"""Contents of a run's files by their path below its folder."""
_PROGRAM = "from benchbench.sweep.remote import main; main()"


def run(task: Task, search_path: ConfigSearchPath) -> tuple[Ended | BaseException, Files]:
    """Carry out one task and return its end and its files; called by a worker of the cluster.

    It runs where the sweep was started if that folder is here too, and otherwise in one that is removed.
    """
    job, folder = task[0], task[1].folder
    started = Path(str(job.config.hydra.runtime.cwd))
    below = folder.relative_to(started) if folder.is_relative_to(started) else None
    with contextlib.ExitStack() as stack:
        cwd = str(started)
        if not started.is_dir():
            cwd = stack.enter_context(tempfile.TemporaryDirectory())
            with read_write(job.config.hydra.runtime):
                job.config.hydra.runtime.cwd = cwd
                job.config.hydra.runtime.output_dir = str(folder if below is None else Path(cwd, below))
        done = subprocess.run(
            [sys.executable, "-c", _PROGRAM], input=pickle.dumps((task, search_path)), capture_output=True, cwd=cwd,
            env={**os.environ, "OMP_NUM_THREADS": os.environ.get("OMP_NUM_THREADS", "1")}, check=False,
        )  # fmt: skip
        if done.returncode:
            said = done.stderr.decode(errors="replace").strip().splitlines()[-1:]
            how = f"ended with exit code {done.returncode}"
            return Crash(f"the run's process on the cluster {how}: {''.join(said)}"), {}
        end: Ended | BaseException = pickle.loads(done.stdout)
        return end, _files(folder if below is None else Path(cwd, below))


def main() -> None:
    """Read a task from standard input, carry it out, write its end to standard output."""
    processes.die_with_parent()
    answer = os.dup(1)
    os.dup2(2, 1)  # nothing else may write there
    task, search_path = pickle.load(sys.stdin.buffer)
    ends = [end for _, end in run_all(iter([task]), search_path)]
    with open(answer, "wb") as out:
        pickle.dump(ends[0], out)


def _files(folder: Path) -> Files:
    paths = [path for path in folder.rglob("*") if path.is_file()]
    return {str(path.relative_to(folder)): path.read_bytes() for path in paths}
