"""Sweeps on a Dask cluster as a user runs them: a real scheduler and real workers on this machine."""

from __future__ import annotations

import json
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
from program import COMMAND, ENVIRONMENT, records, told
from sweeps import BAD, RUNS, SWEEP, answers, path_with_bad_runs

from benchbench.run import config
from benchbench.run.execution import Ended
from benchbench.storage.table import read
from benchbench.sweep import cluster as remote_cluster
from benchbench.sweep import remote
from benchbench.sweep.job import Job

pytest.importorskip("distributed")
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="kills process groups")


@contextmanager
def started(folder: Path, *arguments: str) -> Iterator[subprocess.Popen[bytes]]:
    """A Dask process that leads its own group; the group is killed in the end."""
    with (folder / f"{len(list(folder.iterdir()))}.log").open("wb") as log:
        process = subprocess.Popen(
            [sys.executable, "-m", "distributed.cli." + arguments[0], *arguments[1:]], cwd=folder, stdout=log,
            stderr=log, start_new_session=True,
            env={**os.environ, **ENVIRONMENT, "PYTHONPATH": path_with_bad_runs()},
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


def written_address(file: Path) -> str:
    """Address of a scheduler from its file, once that is there and whole."""
    limit = time.monotonic() + 60.0
    while True:
        try:
            return str(json.loads(file.read_text())["address"])
        except (OSError, ValueError):
            if time.monotonic() > limit:
                raise
            time.sleep(0.05)


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
        address = written_address(file)
        with started(folder, *worker) as one, started(folder, *worker) as other:
            yield address, [one, other]


@pytest.mark.slow
def test_bad_runs_cost_their_row_and_a_lost_worker_nothing(tmp_path: Path, calm_sweep: Path) -> None:
    """One after the other on one cluster, whose start takes as long as a run."""
    bad, far = tmp_path / "bad", tmp_path / "far"
    bad.mkdir(), far.mkdir()
    with cluster(tmp_path / "cluster") as (address, workers):
        there = ("hydra/launcher=dask", f"hydra.launcher.scheduler={address}")
        for how in (("+strategy.how=segfault,exit,fine",), ("+strategy.how=spin", "hard_limit=2")):
            done = told(bad, "-m", "+scenario=static", *BAD, *how, *there)
            assert done.returncode == 1, done.stderr
        assert all(worker.poll() is None for worker in workers)
        command, environment = [*COMMAND, *SWEEP, *there], {**os.environ, **ENVIRONMENT}
        sweep = subprocess.Popen(
            command, cwd=far, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
        )
        limit = time.monotonic() + 120.0
        while not list(far.glob("results/table/*.parquet")) and time.monotonic() < limit:
            time.sleep(0.02)
        kill(workers[0])
        assert len(read(far / "results")) < RUNS  # it was killed in the middle
        said, _ = sweep.communicate(timeout=200)
        assert sweep.returncode == 1, said.decode()
        again = told(far, *SWEEP, *there)
    assert f"{RUNS} of {RUNS} runs are in the table" in again.stdout
    pd.testing.assert_frame_equal(answers(far / "results"), answers(calm_sweep / "results"))
    assert len(list(far.rglob("plan.mcap"))) == RUNS
    assert sorted(r["status"] for r in records(bad)) == ["crash", "crash", "timeout", "uncertified"]
    assert len(read(bad / "results")) == 4


def test_files_come_back_without_a_shared_file_system(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    started_in = tmp_path / "elsewhere"
    started_in.mkdir()
    monkeypatch.chdir(started_in)
    with hydra.initialize_config_dir(config.folder(), version_base="1.3"):
        overrides = [
            "+scenario=static",
            "strategy=phases",
            "strategy.margin=0",
            "scenario.intervals=12",
            "picture=true",
            "hydra.mode=MULTIRUN",
        ]
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


@pytest.mark.parametrize(
    ("given", "said"),
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
def test_bad_input(
    tmp_path: Path, given: tuple[str, ...], said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(remote_cluster, "CONNECT_S", 1.0)
    done = told(tmp_path, *SWEEP, "hydra/launcher=dask", *given)
    assert done.returncode == 2, done.stdout + done.stderr
    assert said in done.stderr
    assert "Traceback" not in done.stderr
