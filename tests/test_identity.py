"""One run, one folder, one row: folders that two runs were given, records without a row, files that went missing."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from program import assert_refused, records, told
from sweeps import QUICK

from benchbench.storage.adopt import adopt, whole
from benchbench.storage.configuration import read as read_yaml
from benchbench.storage.files import run_name, write_record
from benchbench.storage.locks import LOCKS
from benchbench.storage.schema import make_record
from benchbench.storage.table import folder, read

SAME = ("hydra.sweep.dir=results/mine", "hydra.sweep.subdir=same")
FILES = {"config.yaml", "plan.mcap", "plan.png", "record.json"}


def told_by(place: Path) -> tuple[str, str]:
    """The scenario that the record of a run says, and the one of its configuration."""
    (record,) = records(place)
    return record["scenario"], read_yaml(place / "config.yaml")["scenario"]["name"]


@pytest.mark.slow
def test_runs_that_are_given_one_folder_get_one_each_and_resuming_makes_them_whole(tmp_path: Path) -> None:
    sweep = ("-m", "+scenario=static,linear", *QUICK[:-1], "picture=true", *SAME, "workers=1")
    assert told(tmp_path, *sweep).returncode == 1
    mine = tmp_path / "results" / "mine"
    assert {place.name: told_by(place) for place in mine.glob("same*")} == {
        "same": ("static", "static"), "same.2": ("linear", "linear"),
    }  # fmt: skip
    assert all({file.name for file in place.iterdir()} >= FILES for place in mine.glob("same*"))
    table = folder(tmp_path / "results")
    assert sorted(read(tmp_path / "results").scenario) == ["linear", "static"]

    (table / "mine_same.parquet").unlink()
    (mine / "same.2" / "plan.png").unlink()
    again = told(tmp_path, *sweep)
    assert "2 of 2 runs are in the table and are skipped" in again.stdout
    assert len(records(mine)) == 2 and sorted(read(tmp_path / "results").scenario) == ["linear", "static"]
    assert (mine / "same.2" / "plan.png").read_bytes().startswith(b"\x89PNG")

    (mine / "same" / "plan.mcap").unlink()
    before = (mine / "same.2" / "record.json").read_bytes()
    assert "1 of 2 runs are in the table and are skipped" in told(tmp_path, *sweep, "picture=false").stdout
    assert (mine / "same" / "plan.mcap").is_file() and len(records(mine)) == 2
    assert (mine / "same.2" / "record.json").read_bytes() == before


def test_a_folder_is_anothers_while_a_run_is_at_work_in_it(tmp_path: Path) -> None:
    place, root = tmp_path / "results" / "here", tmp_path / "results"
    code = (
        "import sys; from pathlib import Path; from benchbench.storage.locks import alone_in\n"
        f"with alone_in(Path({str(place)!r}), Path({str(root)!r})): print(); sys.stdin.readline()"
    )
    other = subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert other.stdout is not None and other.stdout.readline()
    place.mkdir()
    (place / "plan.mcap").write_text("theirs")
    run = ("+scenario=static", *QUICK, f"hydra.run.dir={place}")
    assert_refused(told(tmp_path, *run), "hydra.run.dir", "another run is at work in")
    assert (place / "plan.mcap").read_text() == "theirs" and not records(root)
    other.communicate("\n", timeout=60)
    assert told(tmp_path, *run).returncode == 1
    assert len(records(root)) == 1 and (root / LOCKS).exists()


def test_no_two_folders_have_one_name() -> None:
    root = Path("/r")
    plain = ("sweeps/2026-01-01/12-00-00-000001/3", "mine/same.2", "one_word", "2026-11-29")
    assert [run_name(root / path, root) for path in plain] == [path.replace("/", "_") for path in plain]
    others = ("a_b/c", "a/b_c", "a/b/c/d/e", "x/b/c/d/e", "a b", "a-b", "a%b", ".a", "a", "é", "q" * 300, "p" + "q" * 299,
              "../a", "../../r2/a", "/elsewhere/a", "..")  # fmt: skip
    names = [run_name(root / path, root) for path in others]
    assert len(set(names)) == len(others)
    assert all(len(name) < 200 and name[0] not in ".-" for name in names)


def test_records_without_a_row_are_adopted_once(tmp_path: Path) -> None:
    for place, name in (("runs/a", "runs_a"), ("merged/x", "other"), ("inner/runs/b", "runs_b")):
        write_record(tmp_path / place, make_record(run_id=name, status="crash"))
    (tmp_path / "inner" / "table").mkdir()
    (tmp_path / "broken").mkdir()
    (tmp_path / "broken" / "record.json").write_text("{")
    for _ in range(2):
        assert adopt(tmp_path) == {"runs_a": tmp_path / "runs" / "a", "other": tmp_path / "merged" / "x"}
        assert read(tmp_path).run_id.tolist() == ["other", "runs_a"]


@pytest.mark.parametrize(
    ("columns", "files"),
    [({"travel_time_s": 1.0}, ("config.yaml", "plan.mcap")), ({"objective": 1.0}, ("config.yaml", "solution.json")), ({}, ())],
)  # fmt: skip
def test_what_a_record_promises(columns: dict[str, float], files: tuple[str, ...], tmp_path: Path) -> None:
    record = make_record(run_id="r", **columns)
    for name in files:
        assert not whole(tmp_path, record)
        (tmp_path / name).touch()
    assert whole(tmp_path, record)
