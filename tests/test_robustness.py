"""The table of `benchmarks/robustness.py`: relaxations are told apart, a repeated run counts once, gaps are honest."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest
from test_table import row

from benchbench.storage.table import append, read

sys.path.append(str(Path(__file__).resolve().parents[1] / "benchmarks"))

from robustness import judged, main, table, wide


@pytest.fixture
def lines(tmp_path: Path) -> list[list[str]]:
    """Cells of a table of seven rows of one task: its best is 2.5 s, of a plan of phases."""
    for number, values in enumerate(ROWS):
        standard = {"task_hash": "one", "config_hash": str(number), "seed": 1, "iterations": 10}
        append(row(f"{number:03}", **{**standard, **values}), tmp_path)
    found = table(judged(read(tmp_path)), ["method", "scenario", "N"]).splitlines()
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in found]


ROWS: tuple[dict[str, Any], ...] = (
    {"strategy": "phases", "travel_time_s": 2.5, "config_hash": "again"},
    {"strategy": "phases", "travel_time_s": 2.5, "config_hash": "again"},
    {"relaxation": "paper", "travel_time_s": 2.51},
    {"relaxation": "paper", "travel_time_s": 2.6},
    {"relaxation": "paper", "travel_time_s": 2.0, "certified": False, "status": "uncertified"},
    {"relaxation": "direct", "travel_time_s": None, "certified": False, "claimed_success": False},
    {
        "relaxation": "direct",
        "task_hash": None,
        "certified": None,
        "claimed_success": None,
        "status": "crash",
    },
)


def test_one_line_per_relaxation_and_one_count_per_run(lines: list[list[str]]) -> None:
    names = [line[0] for line in lines[2:]]
    assert names == ["phases", "relax: direct", "relax: paper"]
    head = ["runs", "claimed", "claimed near it", "certified", "within 0.5 %"]
    assert [line[3:8] for line in lines[:1] + lines[2:]] == [
        head,
        ["1", "1", "1", "1", "1"],
        ["2", "0", "0", "0", "0"],
        ["3", "3", "1", "2", "1"],
    ]


def test_gaps_and_travel_times(lines: list[list[str]]) -> None:
    """An uncertified plan is no reference; the travel times of claimed plans show how far apart they are."""
    cells = {line[0]: dict(zip(lines[0], line, strict=True)) for line in lines[2:]}
    assert cells["relax: paper"]["largest gap"] == "4.000 %"
    assert cells["relax: paper"]["travel time s"] == "2.5100"
    assert cells["relax: paper"]["spread"] == "30.000 %"
    assert cells["relax: direct"]["largest gap"] == "-"


def test_wide_shows_every_run_in_its_scenario(tmp_path: Path) -> None:
    """In the order of seeds; bold is certified, and a run without a plan still has its status."""
    runs: tuple[dict[str, Any], ...] = (
        {"seed": 2, "travel_time_s": 2.6, "certified": False, "status": "uncertified"},
        {"seed": 1, "travel_time_s": 2.5},
        {"seed": 1, "scenario": "circle", "travel_time_s": None, "certified": False, "status": "crash"},
    )
    for number, values in enumerate(runs):
        standard = {"task_hash": "one", "config_hash": str(number), "iterations": 10}
        append(row(f"{number:03}", **{**standard, **values}), tmp_path)
    *_, line = wide(judged(read(tmp_path))).splitlines()
    both = "**2.5000**, 10 it, 0.3 s; uncertified (2.600), 10 it, 0.3 s"
    assert line == f"| relax: scholtes | {both} | - | crash |"


def test_the_table_can_be_made_from_the_rows_that_were_kept(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for number, values in enumerate(ROWS):
        standard = {
            "task_hash": "one",
            "config_hash": str(number),
            "seed": 1,
            "iterations": 10,
            "intervals": 100,
        }
        append(row(f"{number:03}", **{**standard, **values}), tmp_path)
    said = []
    for options in (["--output", str(tmp_path), "--keep", str(tmp_path / "rows.csv")],
                    ["--output", str(tmp_path / "rows.csv")]):  # fmt: skip
        monkeypatch.setattr(sys, "argv", ["robustness.py", "--only-table", *options])
        main()
        said.append(capsys.readouterr().out)
    assert said[0] == said[1] and said[0].count("\n") == 2 + 3
