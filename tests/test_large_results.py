"""Large folders of results: rows are read fast and say the same, readers and writers do not meet, the page says what it leaves out."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from test_table import row

from benchbench.storage.collect import collect
from benchbench.storage.files import vacate, write_record
from benchbench.storage.row_file import KEY, MARK, read_rows, row_bytes
from benchbench.storage.schema import COLUMNS, Record, make_record
from benchbench.storage.table import append, folder, frame, table_of

VALUES: dict[str, Any] = {
    "int": 3, "float": 0.1 + 0.2, "str": "über {benchbench.record:{ \\ \"x\"", "bool": False, "strings": ["a", "é"],
    "numbers": {"position": 1e-300, "weird": None},
}  # fmt: skip


def full(**values: Any) -> Record:
    """A record in which every column says something."""
    given = {column.name: VALUES[column.type] for column in COLUMNS}
    return make_record(**{**given, "status": "crash", "run_id": "r", **values})


def parquet_alone(path: Path) -> Path:
    """The same row as another program, or an earlier version, writes it."""
    other = path.with_name("other.parquet")
    pq.write_table(pq.read_table(path, partitioning=None), other, store_schema=False)
    assert not pq.read_metadata(other).metadata
    return other


def test_a_row_says_the_same_to_parquet_and_to_us(tmp_path: Path) -> None:
    for number, record in enumerate((full(), make_record(run_id="empty"), row("usual"))):
        path = tmp_path / f"{number}.parquet"
        path.write_bytes(row_bytes(record))
        assert read_rows(path) == [record]
        told = table_of(read_rows(parquet_alone(path)))
        assert told.equals(table_of([record]))


@pytest.mark.parametrize("said", ['{"run_id"', "[1]", '{"colour":"red"}', "{" * 5000, '{"status":"what"}'])
def test_where_the_footer_says_nothing_of_use_parquet_does(said: str, tmp_path: Path) -> None:
    path = tmp_path / "row.parquet"
    table = table_of([full()])
    with pq.ParquetWriter(path, table.schema) as file:
        file.write_table(table)
        file.add_key_value_metadata({KEY: MARK.decode() + said})
    assert table_of(read_rows(path)).equals(table)


@pytest.mark.parametrize("cut", [0, 3, 9, 4000, -1, -5])
def test_half_a_file_is_no_row(cut: int, tmp_path: Path) -> None:
    path = tmp_path / "row.parquet"
    path.write_bytes(row_bytes(full())[:cut])
    with pytest.raises((ValueError, OSError, pa.ArrowException)):
        read_rows(path)


def test_rows_of_many_runs_keep_their_order_and_types(tmp_path: Path) -> None:
    for number in range(1, 1500, 2):
        (folder(tmp_path) / f"{number:05}.parquet").parent.mkdir(exist_ok=True)
        (folder(tmp_path) / f"{number:05}.parquet").write_bytes(row_bytes(row(f"{number:05}")))
    found = frame(collect([tmp_path]).rows)
    assert found.run_id.tolist() == [f"{number:05}" for number in range(1, 1500, 2)]
    assert found.intervals.dtype == "Int64" and found.certified.dtype == "boolean"


def test_a_row_beside_its_record_is_not_read_and_one_of_other_results_is(tmp_path: Path) -> None:
    ours, theirs = tmp_path / "ours", tmp_path / "theirs"
    write_record(ours / "runs" / "a", row("a"))
    for root in (ours, theirs):
        append(row("a", started_at="2020-01-01"), root)
    assert collect([ours]).rows.num_rows == 1, "a row is made of the record of its name"
    assert collect([ours, theirs]).rows.num_rows == 2
    (folder(ours) / "a.parquet").write_bytes(b"half")
    assert not collect([ours]).problems
    assert list(collect([theirs, ours / "table"]).problems) == [ours / "table" / "a.parquet"]


def test_readers_read_while_a_sweep_writes(tmp_path: Path) -> None:
    done = threading.Event()

    def write() -> None:
        try:
            for number in range(120):
                place = tmp_path / "runs" / str(number % 7)
                vacate(place)
                record = row(f"run-{number % 7}", started_at=str(number), seed=number)
                write_record(place, record)
                append(record, tmp_path)
        finally:
            done.set()

    writer = threading.Thread(target=write)
    writer.start()
    counts = []
    while not done.is_set():
        found = collect([tmp_path])
        assert not found.problems
        counts.append(found.rows.num_rows)
    writer.join()
    assert len(counts) > 2 and max(counts) <= 7 and collect([tmp_path]).rows.num_rows == 7
