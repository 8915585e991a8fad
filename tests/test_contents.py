"""What a run reads is part of its key by content, and what a row promises is on disk before the row is."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from omegaconf import OmegaConf

from benchbench.run.execution import config_hash
from benchbench.storage.contents import contents, source_hash
from benchbench.storage.files import RECORD, vacate, write_record
from benchbench.storage.schema import COLUMNS, make_record
from benchbench.storage.table import append, load_record, read


def key(**fields: Any) -> str:
    return config_hash(OmegaConf.create({"scenario": fields, "output": "anywhere"}))


def test_the_content_of_files_is_part_of_the_key(tmp_path: Path) -> None:
    file = tmp_path / "track.csv"
    file.write_text("x,y,z\n")
    before = key(track=str(file))
    assert before == key(track=str(file))
    file.write_text("x,y,z\n1,2,3\n")
    assert before != key(track=str(file))
    assert before != key(track=str(tmp_path / "other.csv"))
    deep = {"target": {"parts": [{"path": str(file)}]}}
    seen = key(**deep)
    file.write_text("")
    assert seen != key(**deep)


def test_so_is_the_plan_in_the_folder_of_a_run(tmp_path: Path) -> None:
    (tmp_path / "plan.mcap").write_bytes(b"one")
    before = key(guess=str(tmp_path))
    (tmp_path / "plan.mcap").write_bytes(b"two")
    assert before != key(guess=str(tmp_path))


def test_a_text_that_is_no_file_adds_nothing() -> None:
    """Keys of configurations without files are those of before."""
    texts = ["", "circle", "a\nb", "\0", "x" * 5000, "/" + "y" * 300, "${a.b}", ".", "~"]
    assert list(contents({"a": texts, "b": 3, "c": None})) == []


def test_other_source_is_another_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from benchbench.storage import contents as module

    (tmp_path / "plugin.py").write_text("a = 1\n")
    monkeypatch.setattr(module, "_packages", lambda: {tmp_path})

    def now() -> str:
        source_hash.cache_clear()
        return source_hash()

    before = now()
    (tmp_path / "notes.txt").write_text("no source")
    assert now() == before
    (tmp_path / "plugin.py").write_text("a = 2\n")
    assert now() != before
    monkeypatch.undo()
    source_hash.cache_clear()


def test_counts_that_cannot_be_true_and_text_that_cannot_be_written_cost_no_table(tmp_path: Path) -> None:
    """A solver that never ran told -20924272000 iterations; a row with 10^20 intervals killed every reader."""
    record = make_record(
        run_id="one", status="error", iterations=-20924272000, intervals=99999999999999999999, seed=2**70,
        n_variables=7, reasons=["a \ud800 b", "x"], advice="\udfff",
    )  # fmt: skip
    assert [record[c] for c in ("iterations", "intervals", "seed", "n_variables")] == [None, None, None, 7]
    append(record, tmp_path)
    assert read(tmp_path).n_variables.tolist() == [7]
    write_record(tmp_path / "one", record)
    assert load_record(tmp_path / "one" / RECORD)["n_variables"] == 7


def test_every_count_has_a_plausible_range() -> None:
    for column in COLUMNS:
        low, high = column.plausible
        assert -(2**63) <= low <= high < 2**63


@pytest.mark.parametrize(
    "text", ["[" * 100_000, '{"a":' * 50_000 + "1" + "}" * 50_000, "[]", "1", "{", "\ud800"]
)
def test_a_record_that_cannot_be_used_is_told(tmp_path: Path, text: str) -> None:
    (tmp_path / RECORD).write_bytes(text.encode("utf-8", "surrogatepass"))
    with pytest.raises((ValueError, TypeError)):
        load_record(tmp_path / RECORD)


def test_no_old_file_stands_beside_a_new_record(tmp_path: Path) -> None:
    for name in ("record.json", "plan.mcap", "plan.png", "config.yaml", "solution.json", "notes.txt"):
        (tmp_path / name).write_text(json.dumps(name))
    vacate(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"], "what is not ours stays"
    (tmp_path / "plan.mcap").mkdir()
    (tmp_path / "plan.png").write_text("old")
    vacate(tmp_path)
    assert not (tmp_path / "plan.png").exists(), "what cannot be removed does not keep the others"
