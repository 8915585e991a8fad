"""`benchbench table`: it finds every run once, keeps every value, says what it left out and refuses nonsense."""

from __future__ import annotations

import io
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pandas as pd
import pyarrow.parquet as pq
import pytest
from program import COMMAND, assert_refused, told

from benchbench.cli import commands
from benchbench.ground.errors import BadInput
from benchbench.storage.collect import collect
from benchbench.storage.describe import describe
from benchbench.storage.files import write_record
from benchbench.storage.schema import COLUMNS, Record, make_record
from benchbench.storage.table import append

ROOT = Path(__file__).resolve().parents[1]


def row(run_id: str, **values: Any) -> Record:
    standard = {
        "scenario": "static", "relaxation": "scholtes", "solver": "ipopt", "dynamics": "verlet", "strategy": "relax",
        "vehicle": "table1", "guess": "line", "intervals": 20, "kappa_init": 2, "status": "certified",
        "certified": True, "claimed_success": True, "reasons": [], "travel_time_s": 2.5, "solve_cpu_s": 0.1 + 0.2,
        "started_at": f"2026-01-01T00:00:00.{run_id}",
    }  # fmt: skip
    return make_record(run_id=run_id, **{**standard, **values})


@pytest.fixture
def results(tmp_path: Path) -> Path:
    """Two good runs, a failed one and one of which only the row in the table is left."""
    root = tmp_path / "results"
    failed = {
        "status": "crash",
        "certified": False,
        "travel_time_s": None,
        "reasons": ["a | b", "100 % \\ _x_"],
    }
    rows = [row("a"), row("b", relaxation="kadrani", solve_cpu_s=2.0), row("c", **failed)]
    for record in rows:
        write_record(root / "runs" / record["run_id"], record)
        append(record, root)
    append(row("lost", scenario="circle"), root)
    return root


def test_every_run_is_found_once_with_its_folder(results: Path) -> None:
    found = collect([results, results / "runs"])
    assert found.rows["run_id"].to_pylist() == ["a", "b", "c", "lost"]
    assert found.folders == (*(results / "runs" / name for name in "abc"), None)
    assert found.problems == {}


def test_runs_of_two_machines_with_one_name_are_two_runs(results: Path) -> None:
    write_record(results.parent / "other" / "a", row("a", started_at="2027-01-01", solver="uno"))
    found = collect([results, results.parent / "other"])
    assert found.rows["run_id"].to_pylist().count("a") == 2


def test_broken_files_are_named_and_cost_nothing_else(results: Path) -> None:
    for name, text in {
        "cut": '{"run_id": "x',
        "list": "[1]",
        "alien": '{"colour": "red"}',
        "odd": "\xff",
    }.items():
        (results / name).mkdir()
        (results / name / "record.json").write_bytes(text.encode("latin-1"))
    (results / "table" / "cut.parquet").write_bytes((results / "table" / "a.parquet").read_bytes()[:-9])
    pd.DataFrame({"x": [1]}).to_parquet(results / "else.parquet")
    found = collect([results])
    assert len(found.rows) == 4
    assert {path.parent.name for path in found.problems} == {
        "cut",
        "list",
        "alien",
        "odd",
        "table",
        "results",
    }
    done = told(results.parent, "table", "--columns", "run_id")
    assert done.returncode == 0
    assert done.stderr.count("left out") == 6
    assert done.stdout.splitlines()[2:] == [f"| {name} |" for name in ("a", "b", "c", "lost")]


def test_an_older_record_without_todays_columns_is_read(results: Path) -> None:
    path = results / "runs" / "a" / "record.json"
    old = {key: value for key, value in json.loads(path.read_text()).items() if key != "advice"}
    path.write_text(json.dumps(old))
    assert collect([results]).rows["advice"].to_pylist()[0] is None


def test_parquet_keeps_values_types_and_meanings(results: Path) -> None:
    assert commands.run("table", [str(results), "--output", str(results.parent / "all.parquet")]) == 0
    table = pq.read_table(results.parent / "all.parquet")
    assert table.column_names == [column.name for column in COLUMNS]
    assert table["solve_cpu_s"].to_pylist()[0] == 0.1 + 0.2
    assert table["reasons"].to_pylist()[2] == ["a | b", "100 % \\ _x_"]
    assert table.schema.field("travel_time_s").metadata[b"unit"] == b"s"


def test_csv_on_stdout_keeps_every_digit(results: Path) -> None:
    done = told(results.parent, "table", "--format", "csv")
    rows = pd.read_csv(io.StringIO(done.stdout))
    assert rows.columns.tolist() == [column.name for column in COLUMNS]
    assert rows.solve_cpu_s[0] == 0.1 + 0.2
    assert rows.reasons[2] == "a | b; 100 % \\ _x_"
    assert rows.travel_time_s.isna().tolist() == [False, False, True, False]


def test_markdown_is_short_and_escapes(results: Path) -> None:
    short = told(results.parent, "table").stdout.splitlines()
    assert len(short) == 6 and short[0].startswith("| scenario |") and "run_id" not in short[0]
    named = told(results.parent, "table", "--columns", "run_id,reasons").stdout.splitlines()
    assert named[4] == "| c | a \\| b; 100 % \\ _x_ |"


def test_latex_is_an_escaped_booktabs_table(results: Path) -> None:
    commands.run("table", [str(results), "--columns", "run_id,reasons,travel_time_s", "--output",
                           str(results.parent / "t.tex")])  # fmt: skip
    lines = (results.parent / "t.tex").read_text().splitlines()
    assert lines[:3] == [r"\begin{tabular}{llr}", r"\toprule", r"run\_id & reasons & travel\_time\_s \\"]
    assert r"c & a | b; 100 \% \textbackslash \space \_x\_ &  \\" in lines


def test_a_query_sees_the_table_runs(results: Path, capfd: pytest.CaptureFixture[str]) -> None:
    sql = "select relaxation, count(*) as n from runs where certified group by relaxation order by n"
    commands.run("table", [str(results), "--query", sql])
    assert capfd.readouterr().out.splitlines()[2:] == ["| kadrani | 1 |", "| scholtes | 2 |"]


@pytest.mark.parametrize(
    ("sql", "says"),
    [
        ("select nothing from runs", "nothing"),
        ("selec", "selec"),
        ("", "no table"),
        ("select 1 a, 2 a", "one name"),
    ],
)
def test_a_bad_query_is_bad_input(results: Path, sql: str, says: str) -> None:
    with pytest.raises(BadInput, match=says):
        commands.run("table", [str(results), "--query", sql])


@pytest.mark.parametrize(
    ("arguments", "field", "says"),
    [
        (["nowhere"], "nowhere", "no such folder"),
        (["--columns", "travel_time"], "--columns travel_time", "'travel_time_s' is meant"),
        (["--output", "runs.xlsx"], "output", ".parquet, .csv, .md, .tex"),
        (["--format", "xml"], "benchbench table", "invalid choice"),
        (["--colums", "x"], "benchbench table", "--colums"),
    ],
)
def test_bad_arguments_are_bad_input(results: Path, arguments: list[str], field: str, says: str) -> None:
    assert_refused(told(results.parent, "table", *arguments), field, says)


def test_no_runs_give_an_empty_table_with_all_columns(tmp_path: Path) -> None:
    (tmp_path / "results").mkdir()
    assert told(tmp_path, "table").returncode == 0
    assert told(tmp_path, "table", "--output", "none.csv").returncode == 0
    assert len((tmp_path / "none.csv").read_text().splitlines()) == 1


def test_parquet_goes_through_a_pipe(results: Path) -> None:
    command = [*COMMAND, "table", str(results), "--format", "parquet"]
    done = subprocess.run(command, capture_output=True, timeout=100, check=True)
    assert len(pd.read_parquet(io.BytesIO(done.stdout))) == 4


def test_the_columns_are_documented() -> None:
    assert (ROOT / "docs" / "table.md").read_text() == describe(), (
        "benchbench table --describe > docs/table.md"
    )
    for column in COLUMNS:
        assert f"| `{column.name}` | {column.type} | {column.unit} |" in describe()


def test_without_the_extra_the_remedy_is_named(results: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "duckdb", None)
    done = told(results.parent, "table", "--query", "select 1")
    assert done.returncode == 2
    assert "pip install 'benchbench[report]'" in done.stderr
