"""Bad input to every command: one message that names the field, exit code 2, no traceback, nothing left behind."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

import bad_inputs
import pytest
from bad_inputs import CERTIFY, OTHERS, RUNS, SWEEPS
from program import told

from benchbench.cli import commands

ALL = (*RUNS, *SWEEPS, *CERTIFY, *OTHERS)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The files that the command lines name."""
    made = tmp_path_factory.mktemp("bad")
    bad_inputs.files(made)
    return made


@pytest.fixture(scope="module")
def here(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Where the commands are called; afterwards no run's folder and no row is there."""
    place = tmp_path_factory.mktemp("here")
    yield place
    left = {path.relative_to(place).parts[:3] for path in place.rglob("*")}
    told_only = [part for part in left if part[1:2] not in ((), ("table",), (".claims",), ("sweeps",))]
    assert not told_only, left
    assert not list(place.rglob("record.json")) and not list(place.rglob("*.parquet"))


def test_every_command_is_asked() -> None:
    assert len(ALL) >= 80
    assert {line.split()[0] for line, _ in (*CERTIFY, *OTHERS)} >= set(commands.names())


@pytest.mark.parametrize(("line", "field"), ALL, ids=[line for line, _ in ALL])
def test_bad_input_is_told_in_one_message(line: str, field: str, folder: Path, here: Path) -> None:
    arguments: Sequence[str] = line.replace("{d}", str(folder)).split()
    done = told(here, *arguments)
    assert done.returncode == 2, done.stderr
    first, second = done.stderr.splitlines()
    assert first == "benchbench: bad input"
    assert re.match(rf"  {re.escape(field.replace('{d}', str(folder)))}[:.,]", second), second
    assert "Traceback" not in done.stderr


def test_a_packed_problem_is_not_unpacked_beyond_its_bound(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import gzip

    from benchbench.ground.errors import BadInput
    from benchbench_plugins.collections import nosbench

    monkeypatch.setattr(nosbench, "JSON_BYTES", 100_000)
    (tmp_path / "bomb.json.gz").write_bytes(gzip.compress(b" " * 10_000_000))
    (tmp_path / "large.json").write_bytes(b" " * 100_001)
    for name in ("bomb.json.gz", "large.json"):
        with pytest.raises(BadInput, match=r"scenario\.path.*is larger than 0\.1 MB"):
            nosbench.MpccFile(tmp_path / name).mpcc()
