"""Whatever a plugin does to its process, its row says so, its neighbours plan as if alone, and nothing of it stays."""

from __future__ import annotations

import os
import pickle
import sys
from pathlib import Path

import pytest
from hostile import WAYS
from hostile_sweep import SLOW, Swept, Truth, alone, swept
from sharing import Once

from benchbench.sweep import log

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform != "linux", reason="asks Linux for processes and their signals"),
]

QUICK = [way for way in WAYS if way not in SLOW]
EVERY = 12
"""After so many hostile runs comes an honest one."""


@pytest.fixture(scope="module")
def sweep(once: Once) -> Swept:
    """All ways but those that end at the wall-clock limit (benchmarks/hostile.py has them, and an honest run after each)."""
    found: Swept = pickle.loads((once("hostile", sweep_of_all) / "swept.pickle").read_bytes())
    return found


def sweep_of_all(folder: Path) -> None:
    names = []
    for n in range(0, len(QUICK), EVERY):
        names += [*QUICK[n : n + EVERY], f"fine_{n}"]
    found = swept(folder / "sweep", names, 2, "+strategy.after=raise")
    (folder / "swept.pickle").write_bytes(pickle.dumps(found))


@pytest.fixture(scope="module")
def truth(tmp_path_factory: pytest.TempPathFactory) -> Truth:
    """What an honest run gives."""
    return alone(tmp_path_factory.mktemp("alone") / "run")


def test_one_typed_row_each_and_right_neighbours_and_nothing_left(sweep: Swept, truth: Truth) -> None:
    assert len(QUICK) > 30
    assert sweep.faults(truth) == []


@pytest.mark.parametrize(
    ("way", "status", "reason"),
    [
        ("system_exit", "error", "SystemExit: 0"),
        ("base_exception", "error", "Abort: not an Exception"),
        ("keyboard_interrupt", "error", "KeyboardInterrupt"),
        ("exit_0", "crash", "exit code 0 before it had told its result"),
        ("segfault", "crash", "died of SIGSEGV"),
        ("kill_its_keeper", "crash", "a plugin may have killed its parent process"),
        ("answer_in_its_own_words", "crash", "exit code 0"),
        ("take_memory", "out_of_memory", ""),
        ("not_even_say", "error", "Mute"),
        ("remove_its_files", "error", "RuntimeError: spoiled"),
    ],
)
def test_each_end_is_named(sweep: Swept, way: str, status: str, reason: str) -> None:
    (row,) = sweep.rows[way]
    assert row["status"] == status
    assert reason in row["reasons"][0]


@pytest.mark.skipif(os.geteuid() != 0, reason="only root has rights to drop")
def test_a_run_that_may_not_write_any_more_has_its_row(sweep: Swept) -> None:
    (row,) = sweep.rows["drop_rights"]
    told = {
        "bad_input": "could not store its record",
        "crash": "could not tell its result",
    }  # where even imports need them
    assert told[row["status"]] in row["reasons"][0]


def test_what_a_run_says_is_cut(sweep: Swept) -> None:
    (much,), (odd,) = sweep.rows["say_much"], sweep.rows["say_nothing_printable"]
    assert len(much["reasons"][0]) < 3_000
    assert odd["reasons"] == ["\ufffd[2J: \ufffd[31m\ufffd\ufffd \ufffd =cmd()"]
    logs = [path.stat().st_size for path in sweep.folder.rglob("output.log")]
    assert log.KEPT < max(logs) < log.KEPT + 2 * log.TAIL  # of 100 MB
    assert len(sweep.done.stderr) < 1_000_000 and "\x1b" not in sweep.done.stderr
