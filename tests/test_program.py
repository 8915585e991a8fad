"""The program as a user runs it: exit codes, messages, what is left on the disk, Ctrl-C and kill."""

from __future__ import annotations

import json
import math
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pandas as pd
import pytest
from bad_inputs import SCENARIOS
from program import COMMAND, Done, assert_refused, listen, on_terminal, program, records, told
from sweeps import QUICK

from benchbench.ground.families import FLOWN
from benchbench.storage.schema import COLUMNS
from benchbench.storage.table import read

EXAMPLE = Path(__file__).resolve().parents[1] / "examples" / "own_config"
TYPES = {"int": int, "float": float, "str": str, "bool": bool, "strings": list, "numbers": dict}
needs_terminal = pytest.mark.skipif(sys.platform == "win32", reason="pseudo-terminals are POSIX")


@pytest.fixture(scope="module")
def certified(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Done]:
    """One whole run as the README shows it, default grid."""
    folder = tmp_path_factory.mktemp("certified")
    return folder, program(folder, "+scenario=static")


def test_certified_plan_ends_with_zero(certified: tuple[Path, Done]) -> None:
    folder, done = certified
    assert done.returncode == 0
    assert done.stderr == ""
    (record,) = records(folder)
    assert (record["status"], record["claimed_success"], record["certified"]) == ("certified", True, True)
    assert record["reasons"] == []
    assert record["travel_time_s"] == pytest.approx(2.688, abs=2e-3)  # an independent prototype: 2.6881


def test_record_has_every_column_with_its_type_and_no_nan(certified: tuple[Path, Done]) -> None:
    folder, _ = certified
    (path,) = folder.rglob("record.json")
    assert not {"NaN", "Infinity"} & set(path.read_text().replace(",", " ").split())
    record = json.loads(path.read_text())
    assert list(record) == [column.name for column in COLUMNS]
    for column in COLUMNS:
        value = record[column.name]
        assert isinstance(value, TYPES[column.type]) or value is None, column.name
        assert not isinstance(value, float) or math.isfinite(value), column.name
    unknown = {name for name, value in record.items() if value is None}
    races = {"gates", "gates_passed", "gate_worst_miss_m"}
    unasked = {
        "search",
        "conflict",
        "kkt_residual",
        "stationarity",
        "b_stationary",
        "costs",
        "reference_cpu_s",
        "best_known_objective",
        "published_objective",
        "published_source",
    }
    flights = {"controller_cpu_p50_s", "controller_cpu_p99_s", "real_time_factor", *FLOWN}
    flights |= {name for name in record if name.startswith(("flight", "replan"))}
    searches = {"optima", "refinement", "starts", "starts_certified", "starts_high", "starts_low"}
    assert unknown <= {
        "git_commit",
        "git_dirty",
        *unasked,
        *searches,
        *races,
        *flights,
    }  # an installed package has no checkout
    assert record["threads"] == 1


def test_run_leaves_its_files_and_its_row(certified: tuple[Path, Done]) -> None:
    folder, _ = certified
    (run,) = (folder / "results" / "runs").glob("*/*")
    assert {"config.yaml", "plan.mcap", "plan.png", "record.json"} <= {path.name for path in run.iterdir()}
    (record,) = records(folder)
    row = read(folder / "results").iloc[0]
    assert (row["run_id"], row["certified"]) == (record["run_id"], True)
    assert row["travel_time_s"] == record["travel_time_s"]


def test_summary_is_short_and_plain_on_a_pipe(certified: tuple[Path, Done]) -> None:
    folder, done = certified
    lines = done.stdout.splitlines()
    assert len(lines) <= 14
    assert max(map(len, lines)) <= 80
    assert "\x1b" not in done.stdout
    assert any(line.split() == ["verdict", "certified"] for line in lines)
    (record,) = records(folder)
    assert any(line.startswith(f"travel time  {record['travel_time_s']:.4f} s") for line in lines)
    shown = next(line.split()[1] for line in lines if line.startswith("files"))
    assert (folder / shown / "record.json").is_file()


BROKEN = '''
import numpy as np
from benchbench.nlp.solver import Outcome, Point, Solver

class Broken(Solver):
    """Claims success and returns what its name says."""
    def __init__(self, how): self.how = how
    def native_options(self, setup): return {}
    def version(self): return "broken 1"
    def prepare(self, mpcc, setup):
        def solve(sigma, start):
            if self.how == "raises":
                raise RuntimeError("first line\\nout of cheese")
            return Outcome("solved", Point(np.full_like(start.x, np.nan)), np.nan, 7, 7, 0.0, "fine")
        return solve
'''


@pytest.mark.parametrize(
    ("how", "reason"), [("nan", "the solver says fine"), ("raises", "RuntimeError: out of cheese")]
)
def test_broken_solver_leaves_a_record(tmp_path: Path, how: str, reason: str) -> None:
    (tmp_path / "broken.py").write_text(BROKEN)
    (tmp_path / "own" / "solver").mkdir(parents=True)
    (tmp_path / "own" / "solver" / "broken.yaml").write_text(f"_target_: broken.Broken\nhow: {how}\n")
    done = told(
        tmp_path, "--config-dir", "own", "+scenario=static", *QUICK, "solver=broken", PYTHONPATH=str(tmp_path)
    )
    assert done.returncode == 1
    assert "Traceback" not in done.stderr
    (record,) = records(tmp_path)
    assert (record["status"], record["claimed_success"], record["certified"]) == ("error", False, False)
    assert record["reasons"][0] == reason
    assert record["objective"] is None
    assert list(read(tmp_path / "results")["status"]) == ["error"]
    if how == "raises":
        assert done.stderr.splitlines()[:2] == ["benchbench: the run stopped with an error", f"  {reason}"]


@pytest.mark.parametrize(
    ("arguments", "field", "says"),
    [
        (["solver=ipopt"], "scenario", "one of " + SCENARIOS),
        (["+scenario=static", "scenario.kapa_init=3"], "scenario.kapa_init", "perhaps 'kappa_init' is meant"),
        (["+scenario=static", "+solver.options.nonsense=1"], "solver", "No such IPOPT option: nonsense"),
        (["+scenario=static", "output=/proc/nope"], "output", "a folder you may write to"),
        (["+scenario=static", "output=file/below"], "output", "a folder you may write to"),
        (["+scenario=static", "output=taken"], "output", "taken/table"),
        (["--colour"], "--colour", "what --help shows"),
    ],
)  # fmt: skip
def test_bad_input_is_one_message_and_nothing_is_computed(
    tmp_path: Path, arguments: list[str], field: str, says: str
) -> None:
    (tmp_path / "file").touch()
    (tmp_path / "taken").mkdir()
    (tmp_path / "taken" / "table").touch()  # the run's own folder can be made, the table's cannot
    done = told(tmp_path, *arguments)
    assert_refused(done, field, says)
    assert done.stdout == ""
    assert not list(tmp_path.rglob("*.json")) + list(tmp_path.rglob("*.parquet"))


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="root may write everywhere")
def test_read_only_folder_is_refused(tmp_path: Path) -> None:
    (tmp_path / "locked").mkdir(mode=0o500)
    assert_refused(told(tmp_path, "+scenario=static", "output=locked"), "output", "Permission denied")


def test_traceback_is_shown_when_asked(tmp_path: Path) -> None:
    done = told(tmp_path, "+scenario=static", "vehicle.arm_mass=-1", "--traceback")
    assert done.returncode == 2
    assert done.stderr.startswith("Traceback")
    assert done.stderr.endswith("vehicle.arm_mass: -1 was given; allowed: a number greater than 0\n")


def test_without_arguments_it_explains_itself(tmp_path: Path) -> None:
    done = told(tmp_path)
    assert_refused(done, "scenario", "+scenario=NAME")
    assert "+scenario    block_move, braking, cart_pole, circle, delivery" in done.stdout
    assert not list(tmp_path.iterdir())


def test_row_stays_when_the_picture_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "out" / "plan.png").mkdir(parents=True)
    (tmp_path / "out" / "record.json").write_text("{}")  # of an earlier run
    done = told(tmp_path, "+scenario=static", *QUICK, "picture=true", "hydra.run.dir=out")
    assert_refused(done, "output", "cannot write into")
    (record,) = records(tmp_path)
    assert record["status"] == "uncertified"
    assert list(read(tmp_path / "results")["status"]) == ["uncertified"]


def test_console_script_helps_with_the_choices_of_an_own_folder(tmp_path: Path) -> None:
    script = Path(sys.executable).with_name("benchbench")
    if not script.is_file():
        pytest.skip("benchbench is on the path, but not installed")
    shutil.copytree(EXAMPLE, tmp_path / "own")
    command = [script, "--help", "--config-dir", "own"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert all(name in done.stdout for name in ("circle", "conveyor", "linear", "race", "static"))
    assert "long_arm, " in done.stdout
    assert max(map(len, done.stdout.splitlines())) <= 80


def test_own_files_and_a_plan_that_is_not_certified(tmp_path: Path) -> None:
    """A relative folder; 12 intervals are too few for any certificate."""
    shutil.copytree(EXAMPLE, tmp_path / "own")
    done = told(tmp_path, "--config-dir", "own", "+scenario=conveyor", "vehicle=long_arm", *QUICK)
    assert (done.returncode, done.stderr) == (1, "")
    (record,) = records(tmp_path)
    assert (record["scenario"], record["vehicle"]) == ("conveyor", "long_arm")
    assert (record["status"], record["claimed_success"], record["certified"]) == ("uncertified", True, False)
    assert record["reasons"]
    assert "NOT certified (the solver claims success)" in done.stdout
    assert not list(tmp_path.rglob("plan.png")) and "plan.png" not in done.stdout  # picture=false
    assert " more, see the record" in done.stdout
    assert max(map(len, done.stdout.splitlines())) <= 80


def test_overrides_of_own_files_are_checked(tmp_path: Path) -> None:
    shutil.copytree(EXAMPLE, tmp_path / "own")
    done = told(tmp_path, "--config-dir", "own", "+scenario=conveyor", "scenario.target.start=[0,0,0]")
    assert_refused(done, "scenario.target.start", "perhaps 'start_m' is meant")


def test_sweep_gives_one_row_per_combination_also_for_bad_ones(tmp_path: Path) -> None:
    done = told(tmp_path, "-m", "+scenario=static,linear", "scenario.kappa_init=90,2", *QUICK, "workers=1")
    assert done.returncode == 2
    rows = read(tmp_path / "results")
    assert len(rows) == 4 and rows["run_id"].is_unique and rows["config_hash"].is_unique
    rows = rows.set_index(["scenario", "kappa_init"])
    for scenario in ("static", "linear"):
        assert rows.loc[(scenario, 90), "status"] == "bad_input"
        assert "do not fit into 12 intervals" in rows.loc[(scenario, 90), "reasons"][0]
        assert rows.loc[(scenario, 2), "claimed_success"]
    assert done.stderr.count("benchbench: bad input (run ") == 2
    assert "Traceback" not in done.stderr
    assert done.stdout.splitlines()[0] == "4 runs to do"
    rows_told = done.stdout.partition("\nscenario ")[0].splitlines()[1:]
    lines = sorted(rows_told, key=lambda line: int(line.split()[0]))  # as they ended
    assert len(lines) == 2
    assert lines[0].split()[:3] == ["2", "NOT:", "uncertified"]
    assert done.stdout.splitlines()[-1] == "0 of 4 runs certified"


def test_a_refused_run_is_skipped_with_its_exit_code_unless_failed_ones_are_asked_for(tmp_path: Path) -> None:
    sweep = ("-m", "+scenario=static", "scenario.kappa_init=90", *QUICK)
    for more, rows, skipped in (((), 1, False), ((), 1, True), (("rerun=failed",), 2, False)):
        done = told(tmp_path, *sweep, *more)
        assert done.returncode == 2
        assert ("1 of 1 runs are in the table" in done.stdout) is skipped
        assert list(read(tmp_path / "results")["status"]) == ["bad_input"] * rows


def test_unknown_choice_in_a_sweep_is_refused_before_the_first_run(tmp_path: Path) -> None:
    done = told(tmp_path, "-m", "+scenario=static,triangle", *QUICK)
    assert_refused(done, "scenario", "'triangle' does not exist")
    assert not list(tmp_path.rglob("record.json"))


@needs_terminal
def test_terminal_shows_a_live_line_that_goes_away(tmp_path: Path) -> None:
    limits = ("strategy=phases", "strategy.attempts=1", "iteration_limit=20")
    with on_terminal(tmp_path, "+scenario=circle", *limits) as (process, terminal):
        heard = listen(terminal)
        assert process.wait() == 1
    live = [line for line in heard.replace("\r", "\n").split("\n") if "iter " in line]
    assert live and all("travel time" in line and "violation" in line for line in live)
    assert heard.index("violation") < heard.index("verdict")
    assert heard.rindex("\x1b[?25h") > heard.rindex("\x1b[?25l")  # the cursor is back
    assert "iter " not in heard[heard.index("verdict") :]
    assert "advice: raise the iteration limit" in heard
    (record,) = records(tmp_path)
    assert (record["status"], record["claimed_success"], record["certified"]) == (
        "iteration_limit",
        False,
        False,
    )
    assert record["iterations"] == 20
    assert record["reasons"][0].startswith("the solver says ")


@needs_terminal
def test_ctrl_c_ends_at_once_with_one_line(certified: tuple[Path, Done]) -> None:
    folder, _ = certified
    before = read(folder / "results")
    with on_terminal(folder, "+scenario=circle", "scenario.intervals=200") as (process, terminal):
        heard = listen(terminal, "iter ")  # IPOPT is at work, in native code
        began = time.monotonic()
        process.send_signal(signal.SIGINT)
        heard += listen(terminal)
        assert process.wait() == 130
        assert time.monotonic() - began < 10
    assert heard.rstrip().endswith(
        "benchbench: interrupted; finished runs are stored, the running one is not"
    )
    assert "Traceback" not in heard
    assert heard.rindex("\x1b[?25h") > heard.rindex("\x1b[?25l")
    pd.testing.assert_frame_equal(read(folder / "results"), before)


@needs_terminal
def test_kill_leaves_earlier_rows_intact(certified: tuple[Path, Done]) -> None:
    folder, _ = certified
    before = read(folder / "results")
    with on_terminal(folder, "+scenario=circle", "scenario.intervals=200") as (process, terminal):
        listen(terminal, "iter ")
        process.kill()
        assert process.wait() == -signal.SIGKILL
    pd.testing.assert_frame_equal(read(folder / "results"), before)


@pytest.mark.skipif(not Path("/proc/self/maps").exists(), reason="asks Linux how far the imports are")
def test_ctrl_c_during_the_imports_is_as_quiet(tmp_path: Path) -> None:
    process = subprocess.Popen(
        [*COMMAND, "+scenario=static"], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )  # fmt: skip
    while "numpy" not in Path(f"/proc/{process.pid}/maps").read_text() and process.poll() is None:
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=30)
    assert process.returncode == 130
    assert said == "benchbench: interrupted; finished runs are stored, the running one is not\n"


def test_reader_that_goes_away_is_no_error(tmp_path: Path) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    with os.fdopen(writer, "w") as closed:
        done = subprocess.run(
            [*COMMAND, "--help"], cwd=tmp_path, stdout=closed, stderr=subprocess.PIPE, text=True, check=False
        )
    assert (done.returncode, done.stderr) == (141, "")
