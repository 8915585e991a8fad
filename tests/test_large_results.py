"""Large folders of results: rows are read fast and say the same, readers and writers do not meet, the page says what it leaves out."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from test_table import row

from benchbench.cli.commands import report
from benchbench.cli.report_content import content
from benchbench.ground.errors import BadInput
from benchbench.report.html import room
from benchbench.report.html.page import render
from benchbench.storage.collect import collect
from benchbench.storage.configuration import configuration
from benchbench.storage.files import vacate, write_record
from benchbench.storage.row_file import KEY, MARK, read_rows, row_bytes
from benchbench.storage.schema import COLUMNS, Record, make_record
from benchbench.storage.settings import SettingsReader, flatten
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
    for number in range(1, 400, 2):
        (folder(tmp_path) / f"{number:05}.parquet").parent.mkdir(exist_ok=True)
        (folder(tmp_path) / f"{number:05}.parquet").write_bytes(row_bytes(row(f"{number:05}")))
    found = frame(collect([tmp_path]).rows)
    assert found.run_id.tolist() == [f"{number:05}" for number in range(1, 400, 2)]
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


TEXTS = (
    "a: 1\nb:\n  c: 2\n  d:\n  - x\n  - y: 1\n    z: 2\n  e: {}\nf: null\n",
    "a:\n- 1\n- 2\nb: yes\non: 1\n'q: x': 2\n",
    "# said\na: 1\n\nb:\n  # inside\n  c: 2\n\n  d: 3\n",
    "a: 'x\n  y: 1'\nb: {c: 1,\nd: 2}\n", "a: &x 1\nb: *x\n", "a: |\n  b: 1\n  c\nd: 2\n", "<<: {a: 1}\na: 2\n",
    "a: 1\na: 2\nb:\n  c: 1\nb:\n  d: 1\n", "- 1\n- 2\n", "text\n", "", "a: 1", "a:\n  b: 1\n c: 2\n", "a: \"\xe9\"\n", "  a: 1\n",
    "a:\n  1: x\n  2020-01-01: y\n", "a:\n  b\n  c\n", "a:\n    b: 1\n    c: 2\n", "? a\n: 1\n", "a: 1\n---\nb: 1\n", "a: \ud800\n",
)  # fmt: skip


def test_settings_read_in_parts_are_those_of_the_whole(tmp_path: Path) -> None:
    reader, known = SettingsReader(), 0
    for text in (*TEXTS, *TEXTS):
        (tmp_path / "config.yaml").write_bytes(text.encode("utf-8", "surrogatepass"))
        tree = configuration(tmp_path)
        assert reader.read(tmp_path) == (None if tree is None else flatten(tree)), text
        known += tree is not None
    assert known >= 24
    assert reader.read(None) is None and reader.read(tmp_path / "nowhere") is None


def many(count: int, **columns: Any) -> pd.DataFrame:
    """That many runs with a method, an outcome and a verdict."""
    runs = pd.DataFrame(
        {"method": ["m"] * count, "status": ["certified"] * count, "certified": [True] * count}
    )
    return runs.assign(**columns)


def test_charts_compare_the_methods_that_certify_most() -> None:
    names = [f"m{i // 2}" for i in range(200)]
    runs = many(200, method=names, certified=[i // 2 % 2 == 1 for i in range(200)])
    shown, settings, said = room.compared(runs, list(range(200)))
    assert shown.method.nunique() == room.METHODS == len(set(shown.method[shown.certified]))
    assert [names[i] for i in settings] == shown.method.tolist(), "each keeps its own settings"
    assert "40 of 100 methods" in said and "80 of 200 runs" in said
    assert room.compared(shown, settings)[2] == ""


def test_a_long_list_has_every_method_and_outcome() -> None:
    runs = many(500, status=["certified"] * 498 + ["crash", None])
    shown, said = room.listed(runs, 10)
    assert len(shown) == 10 and shown.status.iloc[-2:].fillna("none").tolist() == ["crash", "none"]
    assert "10 of 500 runs" in said and "--rows" in said
    assert room.listed(runs, 500)[1] == ""
    dots, told = room.drawn(many(room.POINTS + 1))
    assert len(dots) == room.POINTS and f"{room.POINTS} of {room.POINTS + 1}" in told


def test_the_page_says_what_it_leaves_out(tmp_path: Path) -> None:
    for number in range(6):
        write_record(tmp_path / str(number), row(str(number), solver="uno" if number == 5 else "ipopt"))
    for number in range(room.FILES + 3):
        (tmp_path / f"broken{number}").mkdir()
        (tmp_path / f"broken{number}" / "record.json").write_text("{")
    page = render(content(collect([tmp_path]), [tmp_path], None, 0, rows=2))
    assert "2 of 6 runs are listed" in page and "And 3 more." in page
    assert page.count('class="number" data-key="2.5"') == 2
    with pytest.raises(BadInput, match="--rows: -1 was given"):
        report.run([str(tmp_path), "--rows", "-1"])
