"""What is printed for people fits their terminal, and a pipe gets plain lines."""

from __future__ import annotations

import re
import signal
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from rich.console import Console
from test_table import row

from benchbench.cli import commands, drawn_table, interrupt
from benchbench.cli.application import start
from benchbench.cli.commands import plugins, regress, runs
from benchbench.ground.errors import BadInput
from benchbench.run.fitting import fitted
from benchbench.run.sweep_line import show_line
from benchbench.run.telling import complain
from benchbench.storage.files import write_record
from benchbench.storage.table import table_of
from benchbench.sweep.regression.compare import Change

Look = Callable[[int], None]
ROOT = Path(__file__).parents[1]


@pytest.fixture
def look(monkeypatch: pytest.MonkeyPatch) -> Look:
    """Make standard output a terminal of so many columns."""

    def at(columns: int) -> None:
        monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
        monkeypatch.setenv("COLUMNS", str(columns))

    return at


def test_lines_wrap_at_words_and_go_on_below(look: Look) -> None:
    line = "  name  origin  a text of several words, with a-long-path/that/is/not/cut"
    assert fitted(line, 16) == line  # no terminal
    look(40)
    assert fitted(line, 16).splitlines() == [
        "  name  origin  a text of several words,",
        "                with",
        "                a-long-path/that/is/not/cut",
    ]
    look(120)
    assert fitted(line, 16) == line


def test_a_row_of_a_sweep_says_its_values_where_there_is_no_room_for_names() -> None:
    record = row("a", certified=True, travel_time_s=2.5, status="certified", intervals=100)
    overrides = "+scenario=static scenario.kappa_init=2 relaxation=scholtes"
    for columns, says in ((120, overrides), (80, "static 2 scholtes"), (60, "static 2…")):
        console = Console(width=columns, force_terminal=True, color_system=None, highlight=False)
        with console.capture() as said:
            show_line(1, record, overrides, console)
        assert said.get().rstrip("\n").endswith(says) and len(said.get().rstrip("\n")) <= columns


def test_runs_stand_in_columns_and_without_names_where_those_do_not_fit(
    look: Look, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for name, scenario in (("a" * 30, "static"), ("b" * 30, "two_free")):
        write_record(Path("results", name), row(name, scenario=scenario, travel_time_s=2.5))
    runs.run(["results"])
    piped = capsys.readouterr().out
    assert f"{'a' * 30}  static  " in piped
    for columns, names in ((80, False), (160, True)):
        look(columns)
        runs.run(["results"])
        first, second, _ = capsys.readouterr().out.splitlines()
        assert first.startswith("a" * 30) is names and max(map(len, (first, second))) <= columns
        assert first.index("results/") == second.index("results/")


def test_a_table_tells_once_what_is_the_same_and_names_what_has_no_room(
    look: Look, capsys: pytest.CaptureFixture[str]
) -> None:
    table = table_of(
        row(str(i), scenario=f"task{i}", solver="ipopt", travel_time_s=2.0 + i) for i in range(3)
    )
    some = table.select(["solver", "scenario", "travel_time_s", "run_id", "platform"])
    for columns, lost in ((60, False), (20, True)):
        look(columns)
        assert drawn_table.draw(some)
        said = [re.sub(r"\x1b\[[0-9;]*m", "", line) for line in capsys.readouterr().out.splitlines()]
        together = " ".join(" ".join(said).split())
        assert together.startswith("the same in all 3 rows: solver ipopt")
        assert any(line.split()[:1] == ["task2"] for line in said) and max(map(len, said)) <= columns
        assert any(line.startswith("no room for: run id") for line in said) is lost
    assert not drawn_table.draw(table_of(row(str(i)) for i in range(drawn_table.MOST + 1)))


def test_messages_wrap_at_words_on_a_terminal_only() -> None:
    text = "scenario.contcts: does not exist, perhaps 'contacts' is meant; allowed: start, end"
    for terminal, lines in ((True, 3), (False, 2)):
        console = Console(width=60, force_terminal=terminal, color_system=None, highlight=False)
        with console.capture() as said:
            complain("bad input", text, console=console)
        assert said.get().count("\n") == lines


def test_texts_of_plugins_go_on_below_themselves(look: Look, capsys: pytest.CaptureFixture[str]) -> None:
    look(40)
    plugins._show(["solver", "  name  built-in  one two three four five six"])
    assert capsys.readouterr().out.splitlines() == [
        "solver",
        "  name  built-in  one two three four",
        f"{18 * ' '}five six",
    ]


def test_an_error_after_ctrl_c_is_told_as_that(monkeypatch: pytest.MonkeyPatch) -> None:
    """A library may make another error of the exception; planted: the flag is set as the handler does."""
    monkeypatch.setattr(interrupt, "_heard", False)
    with pytest.raises(KeyboardInterrupt):
        interrupt._interrupted(signal.SIGINT, None)
    assert interrupt.heard()
    with pytest.raises(KeyboardInterrupt):
        start(["+scenario=static", "scenario.nosuch=1"])


def test_ctrl_c_speaks_of_runs_only_where_there_are_some() -> None:
    interrupt.running(True)  # a refusal before, in this process, has left what was true for it
    assert interrupt.message() == "benchbench: interrupted; finished runs are stored, the running one is not"
    try:
        with pytest.raises(BadInput):
            commands.run("draw", ["nowhere"])
        assert interrupt.message() == "benchbench: interrupted"
        assert isinstance(commands.run("tune", [str(ROOT / "examples/tuning/schedule.yaml")]), list)
        assert (
            interrupt.message() == "benchbench: interrupted; finished runs are stored, the running one is not"
        )
    finally:
        interrupt.running(True)


def test_what_regress_measured_stands_in_lines_below_its_case(
    look: Look, capsys: pytest.CaptureFixture[str]
) -> None:
    changes = [
        Change(
            "race warm scholtes", "travel_time_s", "1.24549", "1.24549", 0.0, "same", "at most +0.5% allowed"
        ),
        Change("race warm scholtes", "iterations", "63", "99", 0.571, "WORSE", "at most +30.0% allowed"),
    ]
    look(80)
    regress._list(changes, "title", Console(width=80, color_system=None))
    assert capsys.readouterr().out.splitlines() == [
        "title", "race warm scholtes", "  travel_time_s  1.24549  1.24549     +0.0%  same",
        "  iterations     63       99         +57.1%  WORSE", "    at most +30.0% allowed",
    ]  # fmt: skip
