"""Removing and merging whole runs: a row never outlives its folder unseen, and no run is lost."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from program import told

from benchbench.ground.errors import BadInput
from benchbench.storage.files import RECORD, write_record
from benchbench.storage.runs import merge, remove, stored
from benchbench.storage.schema import make_record
from benchbench.storage.table import append, read


def put(root: Path, name: str, started: str = "2026-01-01", **values: object) -> Path:
    """A run of which only the record matters here."""
    record = make_record(run_id=name, started_at=started, status="certified", **values)
    write_record(root / "runs" / name, record)
    (root / "runs" / name / "plan.mcap").write_text(name)
    append(record, root)
    return root / "runs" / name


def test_a_run_goes_with_its_row(tmp_path: Path) -> None:
    one, two = put(tmp_path, "one"), put(tmp_path, "two")
    assert [run.name for run in remove(tmp_path, ["one"])] == ["one"]
    assert not one.exists() and two.exists() and read(tmp_path).run_id.tolist() == ["two"]
    with pytest.raises(BadInput, match="three: is no run"):
        remove(tmp_path, ["two", "three"])
    assert two.exists(), "nothing is removed unless all is known"
    remove(tmp_path, [str(two)])
    assert not stored(tmp_path)


def test_a_row_without_a_folder_is_told_and_removed(tmp_path: Path) -> None:
    put(tmp_path, "kept")
    shutil.rmtree(put(tmp_path, "gone", travel_time_s=2.5))
    listed = told(tmp_path, "runs", ".")
    assert "2 runs, 1 without a folder" in listed.stdout and "2.5000 s  its folder is gone" in listed.stdout
    assert told(tmp_path, "runs", ".", "--remove-orphans").returncode == 0
    assert read(tmp_path).run_id.tolist() == ["kept"]


def test_merging_keeps_every_run_once(tmp_path: Path) -> None:
    a, b, both = tmp_path / "a", tmp_path / "b", tmp_path / "both"
    put(a, "one"), put(a, "two"), put(b, "one", started="2026-02-02", travel_time_s=3.0)
    assert len(merge(both, [a, b])) == 3
    assert sorted(read(both).run_id) == ["one", "one.2", "two"]
    other = next(run for run in stored(both) if run.name == "one.2")
    assert other.record["travel_time_s"] == 3.0 and other.folder is not None
    assert (other.folder / "plan.mcap").read_text() == "one" and (other.folder / RECORD).is_file()
    assert not merge(both, [a]), "the same again adds nothing"
    assert len(stored(a)) == 2, "what was merged stays where it was"


def test_bad_input(tmp_path: Path) -> None:
    for arguments, says in (
        (("nowhere",), "there is no such folder"),
        ((".", "--status", "fine"), "there is no status"),
    ):
        done = told(tmp_path, "runs", *arguments)
        assert done.returncode == 2 and says in done.stderr
