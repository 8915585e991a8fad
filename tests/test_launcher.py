"""Sweeps as a user runs them: whatever a run does costs one typed row, and nothing is run twice or left behind."""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import pandas as pd
import pytest
from program import COMMAND, ENVIRONMENT, listen, on_terminal, program, records, told
from sweeps import BAD, COARSE, QUICK, RUNS, SWEEP, answers, path_with_bad_runs

from benchbench.run.execution import Ended
from benchbench.storage.collect import collect
from benchbench.storage.schema import make_record
from benchbench.storage.table import read
from benchbench.sweep.display import Display
from benchbench.sweep.processes import descendants

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="asks Linux for processes and their signals")


def processes_in(folder: Path) -> list[int]:
    """Processes whose working directory is the folder; workers inherit it."""
    found = []
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdecimal() and (entry / "cwd").resolve() == folder.resolve():
                state = (entry / "stat").read_text().rpartition(")")[2].split()[0]
                found += [int(entry.name)] if state != "Z" else []
        except OSError:
            continue
    return found


def assert_nothing_left(folder: Path) -> None:
    """Killed processes take a moment to go; a worker that was just starting ends once it has imported its modules."""
    limit = time.monotonic() + 60.0
    while processes_in(folder) and time.monotonic() < limit:
        time.sleep(0.05)
    assert [Path(f"/proc/{pid}/cmdline").read_text() for pid in processes_in(folder)] == []


@pytest.mark.slow
def test_every_bad_end_costs_one_typed_row(tmp_path: Path) -> None:
    """The endless ones have a limit of their own: the one that plans takes its time on a busy machine."""
    bad = ("-m", "+scenario=static", *BAD)
    ways, endless = "segfault,exit,memory,raise,fine", "spin,native"
    done = told(tmp_path, *bad, f"+strategy.how={ways}", "workers=2", "memory_limit_mb=3000")
    assert done.returncode == 1, done.stderr
    assert done.stdout.splitlines()[-1] == "0 of 5 runs certified"
    late = told(
        tmp_path,
        *bad,
        f"+strategy.how={endless}",
        "workers=1",
        "hard_limit=2",
        "hydra.sweep.dir=results/late",
    )
    assert late.returncode == 1, late.stderr
    assert late.stdout.splitlines()[-1] == "0 of 2 runs certified"
    found = sorted(records(tmp_path), key=lambda r: ("late" in r["run_id"], r["run_id"]))
    assert [r["status"] for r in found] == [
        "crash", "crash", "out_of_memory", "error", "uncertified", "timeout", "timeout",
    ]  # fmt: skip
    assert "SIGSEGV" in found[0]["reasons"][0]
    assert "exit code 7" in found[1]["reasons"][0]
    assert found[3]["reasons"] == ["RuntimeError: out of cheese"]
    assert "limit of 2 s" in found[5]["reasons"][0]
    assert len(read(tmp_path / "results")) == 7
    assert_nothing_left(tmp_path)


def test_same_sweep_again_runs_only_what_is_missing(tmp_path: Path) -> None:
    sweep = ("-m", "+scenario=static", *BAD, "workers=1")
    first = told(tmp_path, *sweep, "+strategy.how=exit,fine")
    assert first.returncode == 1
    same = (*sweep, "hard_limit=100", "output=./results")
    again = told(tmp_path, *same, "+strategy.how=exit,fine,raise")
    assert "2 of 3 runs are in the table and are skipped" in again.stdout
    assert sorted(read(tmp_path / "results")["status"]) == ["crash", "error", "uncertified"]
    failed = told(tmp_path, *same, "+strategy.how=fine,raise", "rerun=failed")
    assert "1 of 2 runs are in the table and are skipped" in failed.stdout
    assert len(read(tmp_path / "results")) == 4
    told(tmp_path, *same, "+strategy.how=fine", "rerun=all")
    assert len(read(tmp_path / "results")) == 5


def test_repeats_are_timed_and_asked_for_again(tmp_path: Path) -> None:
    once = ("strategy=relax", "strategy.margin=0", "dynamics=midpoint", "guess=line", "scenario.intervals=12")
    sweep = ("-m", "+scenario=static", "relaxation=scholtes,none", *once, "picture=false", "workers=1")
    assert told(tmp_path, *sweep).returncode == 2
    assert told(tmp_path, *sweep, "repeats=3").returncode == 2
    again = told(tmp_path, *sweep, "repeats=2")
    assert "2 of 2 runs are in the table and are skipped" in again.stdout
    assert again.returncode == 2  # as when it was refused
    rows = read(tmp_path / "results").dropna(subset="repeats").sort_values("repeats")
    assert list(rows["repeats"]) == [1, 3]  # the refused run has none
    once, thrice = rows.to_dict("records")
    assert once["solve_cpu_low_s"] == once["solve_cpu_high_s"] == once["solve_cpu_s"]
    assert thrice["solve_cpu_low_s"] <= thrice["solve_cpu_median_s"] <= thrice["solve_cpu_high_s"]
    assert once["travel_time_s"] == thrice["travel_time_s"]
    assert once["iterations"] == thrice["iterations"]


@pytest.mark.parametrize(
    ("field", "value"),
    [("workers", "0"), ("repeats", "0"), ("rerun", "some"), ("hard_limit", "-1"), ("picture", "no picture")],
)
def test_settings_are_checked(tmp_path: Path, field: str, value: str) -> None:
    done = told(tmp_path, "+scenario=static", f"{field}={value}")
    assert done.returncode == 2
    assert f"  {field}: " in done.stderr


def kill_and_resume(
    folder: Path, kills: int, whole: float, seed: int, sweep: Sequence[str] = SWEEP, look: Callable[[], object] = list
) -> list[int]:  # fmt: skip
    """Start the sweep, kill its parent with SIGKILL at a random moment, `kills` times, then let it end.

    A sweep that is faster than the undisturbed one was is killed before its last row.

    whole: seconds that the undisturbed sweep took; look: called after each kill. Returns how many of the runs had their row at each kill.
    """
    moments, rows = random.Random(seed), []
    for _ in range(kills):
        process = subprocess.Popen(
            [*COMMAND, *sweep], cwd=folder,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env={**os.environ, **ENVIRONMENT},
        )  # fmt: skip
        table = folder / "results" / "table"
        enough = min(RUNS - 1, max(RUNS - 2, len(list(table.glob("*.parquet"))) + 1))
        moment = time.monotonic() + moments.uniform(0.25, 0.75) * whole
        while time.monotonic() < moment and len(list(table.glob("*.parquet"))) < enough:
            time.sleep(0.01)
        process.send_signal(signal.SIGKILL)
        process.wait()
        rows.append(len(read(folder / "results")))
        assert_nothing_left(folder)
        look()
    done = told(folder, *sweep)
    assert done.returncode == 1, done.stderr
    return rows


@pytest.mark.slow
def test_kill_of_the_parent_loses_only_what_was_running(tmp_path: Path, calm_sweep: Path) -> None:
    rows = kill_and_resume(tmp_path, 1, float((calm_sweep / "seconds").read_text()), seed=0)
    assert rows[0] < RUNS  # the kill met a sweep at work
    pd.testing.assert_frame_equal(answers(tmp_path / "results"), answers(calm_sweep / "results"))
    assert len(answers(tmp_path / "results")) == RUNS


@pytest.mark.slow
def test_two_sweeps_into_a_folder_share_the_work(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "benchbench", *SWEEP, "picture=false", "workers=1"]
    both = [
        subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True, env={**os.environ, "OMP_NUM_THREADS": "1"})
        for _ in range(2)
    ]  # fmt: skip
    said = [process.communicate(timeout=300)[0] for process in both]
    assert [process.returncode for process in both] == [1, 1]
    rows = read(tmp_path / "results")
    assert len(rows) == RUNS and rows["config_hash"].is_unique
    assert all(text.splitlines()[-1] == f"0 of {RUNS} runs certified" for text in said)


def test_a_solver_that_overruns_its_time_is_told_to_have(tmp_path: Path) -> None:
    """Uno looks at its clock between iterations only; CasADi calls its end at either limit the same."""
    # its first iteration with N = 20 takes several times the least limit of a solve, 0.1 s
    told(tmp_path, "+scenario=static", "solver=uno", "time_limit=0.02", "scenario.intervals=20", *COARSE)
    (record,) = records(tmp_path)
    assert record["status"] == "time_limit"
    assert " s of " in record["reasons"][0]


def test_ctrl_c_ends_the_sweep_and_its_workers(tmp_path: Path) -> None:
    sweep = ("-m", "+scenario=static,circle", *BAD, "+strategy.how=spin")
    with on_terminal(tmp_path, *sweep, PYTHONPATH=path_with_bad_runs()) as (process, terminal):
        heard = listen(terminal, "0/2")
        limit = time.monotonic() + 60.0
        while len(list(tmp_path.rglob("overrides.yaml"))) < 2 and time.monotonic() < limit:
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        heard += listen(terminal)
        assert process.wait() == 130
    assert heard.rstrip().endswith("the running one is not")
    assert "Traceback" not in heard
    assert records(tmp_path) == []
    assert_nothing_left(tmp_path)


def seconds_of_the_worker(folder: Path, process: subprocess.Popen[str]) -> tuple[float, float]:
    """Seconds from the birth of the process of the run to its death, and those in which it computed."""
    run = None
    while run is None and process.poll() is None:
        run = next(iter(children_of_keepers(process.pid)), None)
        time.sleep(0.01)
    began, used = time.monotonic(), 0.0
    while run is not None and run in processes_in(folder):
        used = max(used, cpu_seconds(run))
        time.sleep(0.05)
    return time.monotonic() - began, used


def cpu_seconds(pid: int) -> float:
    """CPU time that a process has used; 0 if it has gone."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def children_of_keepers(program: int) -> set[int]:
    """Processes of runs: the program starts keepers, which fork them."""
    below = descendants([program])
    return {run for keeper in below for run in descendants([keeper])}


def test_a_single_run_ends_at_its_limit_with_a_record(tmp_path: Path) -> None:
    process = subprocess.Popen(
        [*COMMAND, "+scenario=static", *BAD, "+strategy.how=native", "hard_limit=2"],
        cwd=tmp_path, env={**os.environ, "PYTHONPATH": path_with_bad_runs()}, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    lasted, computed = seconds_of_the_worker(tmp_path, process)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 1
    assert said.splitlines()[0] == "benchbench: the process of the run died" and "limit of 2 s" in said
    (record,) = records(tmp_path)
    assert record["status"] == "timeout" and list(read(tmp_path / "results")["status"]) == ["timeout"]
    assert lasted > 1.0
    assert computed < 3.0  # killed within 1 s: it always computes, and a busy machine gives it less
    assert_nothing_left(tmp_path)


def test_a_single_run_keeps_its_memory_limit(tmp_path: Path) -> None:
    asked = ("+strategy.how=memory", "memory_limit_mb=1500")
    done = told(tmp_path, "+scenario=static", *BAD, *asked)
    assert done.returncode == 1
    assert [r["status"] for r in records(tmp_path)] == ["out_of_memory"]


def test_a_limit_changes_nothing_else_of_a_single_run(tmp_path: Path) -> None:
    free, limited = tmp_path / "free", tmp_path / "limited"
    said = []
    for folder, more in ((free, ()), (limited, ("hard_limit=100", "memory_limit_mb=4000"))):
        folder.mkdir()
        done = told(folder, "+scenario=static", *QUICK, "picture=true", *more)
        assert done.returncode == 1 and done.stderr == ""
        said.append([line for line in done.stdout.splitlines() if not line.startswith(("effort", "files"))])
    assert said[0] == said[1]
    assert answers(free / "results").equals(answers(limited / "results"))
    (run,) = (limited / "results" / "runs").glob("*/*")
    assert {"config.yaml", "plan.mcap", "plan.png", "record.json"} <= {path.name for path in run.iterdir()}


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of 150 kB."""
    disk = tmp_path / "disk"
    disk.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=150k", "tmpfs", str(disk)]
    if shutil.which("mount") is None or subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("may not mount a file system")
    yield disk
    subprocess.run(["umount", str(disk)], check=True)


@pytest.mark.slow
def test_a_disk_that_fills_up_is_named_and_costs_no_earlier_row(small_disk: Path) -> None:
    done = program(small_disk, *SWEEP, "workers=1")  # by itself: the disk is taken away afterwards
    assert done.returncode == 2, done.stderr
    said = [line for line in done.stderr.splitlines() if not line.startswith("benchbench: bad input")]
    assert said and all(line.startswith("  output: cannot write") for line in said), done.stderr
    stored = collect([small_disk / "results"])  # a record, its source, may be there without its row
    assert not stored.problems and 0 < stored.rows.num_rows <= RUNS
    assert set(read(small_disk / "results")["run_id"]) <= set(stored.rows["run_id"].to_pylist())


def test_the_display_counts_what_is_done_by_how_it_ended(capsys: pytest.CaptureFixture[str]) -> None:
    with Display(5, traced=False) as display:
        for status in ("certified", "timeout", "uncertified", "timeout"):
            display.ended(1, ["+scenario=static"], Ended(0, make_record(status=status, scenario="static")))
        (bar,) = display._bar.tasks
        assert (bar.completed, bar.total) == (4, 5)
        assert bar.description == "1 certified, 2 timeout, 1 uncertified"
    out, err = capsys.readouterr()
    assert len(out.splitlines()) == 5 and err == "" and "\x1b" not in out  # plain lines where nobody watches
    assert out.startswith("5 runs to do\n")
