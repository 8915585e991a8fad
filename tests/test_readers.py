"""Readers of files that anybody may have written raise what they document, whatever is in the file.

A few examples in the suite; `BENCHBENCH_EXAMPLES=2000 pytest tests/test_readers.py` tries as many as docs/trust.md says.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import casadi as ca
import pytest
from flights import table_one
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from simulator import fly
from test_large_results import full
from test_picture import curved_plan, dense, task, vehicle

from benchbench.ground.errors import BadInput
from benchbench.ocp.track_file import beside_the_lap, read
from benchbench.run import config
from benchbench.storage.collect import collect
from benchbench.storage.configuration import configuration
from benchbench.storage.plan_file import read_plan
from benchbench.storage.playback import read_mcap
from benchbench.storage.recording import write_mcap
from benchbench.storage.row_file import read_rows, row_bytes
from benchbench.storage.settings import SettingsReader, flatten
from benchbench.storage.table import UNUSABLE, load_record
from benchbench_plugins.collections import probing
from benchbench_plugins.collections.nosbench import FUNCTIONS, NUMBERS, MpccFile
from benchbench_plugins.motions.spline import Spline

EXAMPLES = int(os.environ.get("BENCHBENCH_EXAMPLES", "50"))
tried = settings(
    max_examples=EXAMPLES, deadline=None, database=None, derandomize=EXAMPLES == 50, suppress_health_check=list(HealthCheck)
)  # fmt: skip

SCALARS = st.none() | st.booleans() | st.integers(-(2**70), 2**70) | st.floats() | st.text(max_size=8)
VALUES = st.recursive(
    SCALARS, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=5), inner, max_size=3), max_leaves=8
)  # fmt: skip
YAML = ("lap", "gates", "radius", "start", "end", ":", ": ", "\n", "- ", "[", "]", "{", "}", ",", "1", "0.5", "nan", "1e999", "x", "y", "  ",
        "&a", "*a", "!!bool", "!!int", "!!timestamp", "!!set", "<<", "|", ">", "'", '"', "#", "---", "? ", "~", "width", "yaw", "speed",
        "99999999999999999999")  # fmt: skip
CELLS = (
    "t",
    "x",
    "y",
    "z",
    "p_x",
    "time",
    ",",
    ",",
    ",",
    "\n",
    "\n",
    "1",
    "0.5",
    "-",
    "nan",
    "inf",
    "1e999",
    '"',
    " ",
    "#",
    "\0",
    "é",
    "order",
    "radius",
)


def edits(whole: bytes) -> st.SearchStrategy[bytes]:
    """The file with bytes changed, left out, put in, or cut off."""
    place = st.integers(0, len(whole))
    edit = st.tuples(place, st.integers(0, 12), st.binary(max_size=12))

    def apply(changes: list[tuple[int, int, bytes]]) -> bytes:
        data = bytearray(whole)
        for at, gone, new in changes:
            data[at : at + gone] = new
        return bytes(data)

    return st.lists(edit, max_size=4).map(apply) | place.map(lambda at: whole[:at]) | st.binary(max_size=60)


def tokens(words: tuple[str, ...]) -> st.SearchStrategy[bytes]:
    return st.lists(st.sampled_from(words), max_size=40).map(lambda some: "".join(some).encode())


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("readers")


def only(errors: tuple[type[BaseException], ...], read: Callable[[], Any]) -> None:
    """Call a reader; it may raise these errors and no other."""
    try:
        read()
    except errors:
        return


RECORD = json.dumps(full()).encode()


@tried
@given(
    edits(RECORD)
    | st.dictionaries(st.sampled_from(list(full())), VALUES).map(lambda d: json.dumps(d).encode())
    | VALUES.map(lambda v: json.dumps(v).encode())
)
def test_record(place: Path, data: bytes) -> None:
    folder = place / "record"
    folder.mkdir(exist_ok=True)
    (folder / "record.json").write_bytes(data)
    only((OSError, ValueError, TypeError), lambda: load_record(folder / "record.json"))
    found = collect([folder])
    assert found.rows.num_rows + len(found.problems) == 1


@tried
@given(edits(row_bytes(full())))
def test_row(place: Path, data: bytes) -> None:
    (place / "row.parquet").write_bytes(data)
    only(UNUSABLE, lambda: read_rows(place / "row.parquet"))


CONFIG = b"scenario:\n  name: static\n  intervals: 12\n  contacts:\n    position:\n      limit: 0.02\nseed: 0\nlist:\n- 1\n- a: 2\n"


@tried
@given(edits(CONFIG) | tokens(YAML))
def test_config(place: Path, data: bytes) -> None:
    (place / "config.yaml").write_bytes(data)
    tree = configuration(place)
    assert str(SettingsReader().read(place)) == str(None if tree is None else flatten(tree))


@cache
def plan_csv() -> bytes:
    return "\n".join(fly().csv().splitlines()[:5]).encode()


@cache
def race_model() -> Any:
    return config.compose("+scenario=race", "scenario.gates=1").model


@tried
@given(st.deferred(lambda: edits(plan_csv())) | tokens(CELLS))
def test_plan_csv(place: Path, data: bytes) -> None:
    (place / "plan.csv").write_bytes(data)
    for model in (race_model(), table_one()):
        only((BadInput,), lambda model=model: read_plan(place / "plan.csv", model))


@cache
def recording(folder: Path) -> bytes:
    write_mcap(
        folder / "whole.mcap",
        curved_plan(vehicle(), 0.2),
        dense(curved_plan(vehicle(), 0.2)),
        task(),
        vehicle(),
        {"config": "a: 1"},
    )
    return (folder / "whole.mcap").read_bytes()


@tried
@given(st.data())
def test_mcap(place: Path, data: st.DataObject) -> None:
    (place / "plan.mcap").write_bytes(data.draw(edits(recording(place))))
    only((OSError, ValueError), lambda: read_mcap(place / "plan.mcap"))
    only((BadInput,), lambda: read_plan(place / "plan.mcap", vehicle()))


@cache
def mpcc() -> dict[str, Any]:
    x, p = ca.SX.sym("x", 2), ca.SX.sym("p", 0)
    values = dict(zip(FUNCTIONS.values(), (ca.sumsqr(x), x[0], x[0], x[1]), strict=True))
    told: dict[str, Any] = {
        key: ca.Function(key, [x, p], [value]).serialize() for key, value in values.items()
    }
    return told | dict(zip(NUMBERS, ([1, 1], [0, 0], [9, 9], 0, 9, []), strict=True))


@tried
@given(st.data())
def test_mpcc_json(place: Path, data: st.DataObject) -> None:
    told = mpcc()
    key = data.draw(st.sampled_from(list(told)))
    value = data.draw(
        VALUES | edits(str(told[key]).encode()).map(lambda b: b.decode("latin-1"))
        if key in FUNCTIONS.values()
        else VALUES
    )
    whole = json.dumps(told | {key: value}).encode()
    (place / "problem.json").write_bytes(data.draw(st.just(whole) | edits(whole)))
    only((BadInput,), lambda: MpccFile(place / "problem.json").mpcc())


TRACK = b"start: [0, 0, 1]\ngates: 2\nradius: 0.3\nlap:\n- [1, 0, 1]\n- {x: 2, y: 1, z: 1, width: 1, height: 2, yaw: 0.5, speed: [1, 9]}\n"


@tried
@given(edits(TRACK) | tokens(YAML))
def test_track_yaml(place: Path, data: bytes) -> None:
    (place / "track.yaml").write_bytes(data)
    only((BadInput,), lambda: read(place / "track.yaml", 0.3))
    assert isinstance(beside_the_lap(place / "track.yaml"), dict)


@tried
@given(edits(b"x,y,z,radius\n1,0,1,0.3\n2,1,1,0.3\n3,1,1,0.4\n") | tokens(CELLS))
def test_track_and_target_csv(place: Path, data: bytes) -> None:
    (place / "track.csv").write_bytes(data)
    only((BadInput,), lambda: read(place / "track.csv", 0.3))
    only((BadInput,), lambda: Spline(place / "track.csv").points)


def test_a_damaged_function_that_makes_casadi_loop_or_die_is_no_problem(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(probing, "SECONDS", 1)
    good = mpcc()["g_fun"]
    assert probing.unreadable([good, good]) == ""
    assert "is none that CasADi reads" in probing.unreadable([good, good[:-40]])
    assert probing.unreadable([good.replace("a", "b", 1)]) != ""
    monkeypatch.setattr(probing, "NUMBERS", 1)
    assert "has more than 1 numbers" in probing.unreadable([good])
