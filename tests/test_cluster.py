"""Sweeps on a Dask cluster as a user runs them: a real scheduler and real workers on this machine."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import hydra
import pandas as pd
import pytest
from hydra.core.global_hydra import GlobalHydra
from omegaconf import OmegaConf, open_dict
from program import program, records
from test_launcher import BAD, RUNS, SWEEP, answers, path_with_bad_runs

from benchbench.run import config
from benchbench.run.execution import Ended
from benchbench.storage.table import read
from benchbench.sweep import remote
from benchbench.sweep.job import Job

pytest.importorskip("distributed")
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="kills process groups")

ONE_THREAD = {"OMP_NUM_THREADS": "1"}


@contextmanager
def started(folder: Path, *arguments: str) -> Iterator[subprocess.Popen[bytes]]:
    """A Dask process that leads its own group; the group is killed in the end."""
    with (folder / f"{len(list(folder.iterdir()))}.log").open("wb") as log:
        process = subprocess.Popen(
            [sys.executable, "-m", "distributed.cli." + arguments[0], *arguments[1:]], cwd=folder, stdout=log,
            stderr=log, start_new_session=True,
            env={**os.environ, **ONE_THREAD, "PYTHONPATH": path_with_bad_runs()},
        )  # fmt: skip
    try:
        yield process
    finally:
        kill(process)


def kill(process: subprocess.Popen[bytes]) -> None:
    """End a process and its group without warning."""
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


@contextmanager
def cluster(folder: Path) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """Address of a scheduler, and its two workers."""
    folder.mkdir()
    file = folder / "scheduler.json"
    worker = ("dask_worker", "--scheduler-file", str(file), "--nthreads", "1", "--no-dashboard")
    with started(
        folder,
        "dask_scheduler",
        "--scheduler-file",
        str(file),
        "--port",
        "0",
        "--host",
        "127.0.0.1",
        "--no-dashboard",
    ):
        limit = time.monotonic() + 60.0
        while not (file.is_file() and file.stat().st_size) and time.monotonic() < limit:
            time.sleep(0.05)
        address = pd.read_json(file, typ="series")["address"]
        with started(folder, *worker) as one, started(folder, *worker) as other:
            yield address, [one, other]


def test_a_lost_worker_costs_nothing(tmp_path: Path) -> None:
    local, far = tmp_path / "local", tmp_path / "far"
    local.mkdir(), far.mkdir()
    program(local, *SWEEP, **ONE_THREAD)
    with cluster(tmp_path / "cluster") as (address, workers):
        there = ("hydra/launcher=dask", f"hydra.launcher.scheduler={address}")
        command = [sys.executable, "-m", "benchbench", *SWEEP, *there]
        sweep = subprocess.Popen(command, cwd=far, env={**os.environ, **ONE_THREAD}, stdout=subprocess.PIPE)
        limit = time.monotonic() + 120.0
        while not list(far.glob("results/table/*.parquet")) and time.monotonic() < limit:
            time.sleep(0.02)
        kill(workers[0])
        assert len(read(far / "results")) < RUNS  # it was killed in the middle
        sweep.communicate(timeout=200)
        again = program(far, *SWEEP, *there, **ONE_THREAD)
    assert f"{RUNS} of {RUNS} runs are in the table" in again.stdout
    pd.testing.assert_frame_equal(answers(far / "results"), answers(local / "results"))
    assert len(list(far.rglob("plan.mcap"))) == RUNS


def test_files_come_back_without_a_shared_file_system(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    started_in = tmp_path / "elsewhere"
    started_in.mkdir()
    monkeypatch.chdir(started_in)
    with hydra.initialize_config_dir(config.folder(), version_base="1.3"):
        overrides = ["+scenario=static", "strategy=phases", "scenario.intervals=12", "hydra.mode=MULTIRUN"]
        cfg = hydra.compose("config", overrides, return_hydra_config=True)
        search_path = GlobalHydra.instance().config_loader().get_search_path()
        for key, value in {
            "runtime.cwd": str(started_in),
            "sweep.subdir": "0",
            "job.num": 0,
            "job.id": "0",
        }.items():
            with open_dict(cfg):
                OmegaConf.update(cfg, f"hydra.{key}", value)
        job = Job(1, cfg)
        task = (job, job.place(), job.settings())
    monkeypatch.chdir(tmp_path)
    started_in.rmdir()
    end, files = remote.run(task, search_path)
    assert isinstance(end, Ended), end
    assert end.record is not None and end.record["status"] == "uncertified"
    assert {"record.json", "plan.mcap", "plan.png", "config.yaml"} <= files.keys()
    assert list(tmp_path.iterdir()) == []


def test_bad_runs_cost_their_row_and_no_worker(tmp_path: Path) -> None:
    with cluster(tmp_path / "cluster") as (address, workers):
        done = program(
            tmp_path, "-m", "+scenario=static", *BAD, "+strategy.how=segfault,exit,spin,fine", "hard_limit=15",
            "hydra/launcher=dask", f"hydra.launcher.scheduler={address}", PYTHONPATH=path_with_bad_runs(), **ONE_THREAD,
        )  # fmt: skip
        assert all(worker.poll() is None for worker in workers)
    assert done.returncode == 1, done.stderr
    assert sorted(r["status"] for r in records(tmp_path)) == ["crash", "crash", "timeout", "uncertified"]
    assert len(read(tmp_path / "results")) == 4


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ((), "none was given"),
        (("hydra.launcher.scheduler=tcp://127.0.0.1:9",), "nothing answers"),
        (("hydra.launcher.scheduler=nonsense",), "hydra.launcher.scheduler"),
        (
            ("hydra.launcher.scheduler=tcp://127.0.0.1:9", "hydra.launcher.patience=-1"),
            "hydra.launcher.patience",
        ),
    ],
)
def test_bad_input(tmp_path: Path, given: tuple[str, ...], told: str) -> None:
    done = program(tmp_path, *SWEEP, "hydra/launcher=dask", *given)
    assert done.returncode == 2, done.stdout + done.stderr
    assert told in done.stderr
    assert "Traceback" not in done.stderr
