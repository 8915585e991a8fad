"""`benchbench regress`, as CI runs it: planted losses are found, and nothing else is."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from program import assert_refused, told

from benchbench.errors import BadInput
from benchbench.regression import baseline
from benchbench.regression.compare import compare
from benchbench.regression.matrix import Gates, Matrix

CASE = "[+scenario=static, strategy=phases, scenario.intervals=30]"
MATRIX = f"common: [compile=never]\nrepeats: 5\ncases:\n  small: {CASE}\n"
WAS: dict[str, Any] = {
    "status": "certified", "certified": True, "travel_time_s": 2.0, "objective": 2.1, "iterations": 100,
    "evaluations": 500, "ratios": [1.0, 1.02, 0.98, 1.01, 0.99],
}  # fmt: skip


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    folder = tmp_path_factory.mktemp("regress")
    (folder / "base").mkdir()
    (folder / "base" / "matrix.yaml").write_text(MATRIX)
    done = told(folder, "regress", "--baseline", "base", "--update")
    assert done.returncode == 0, done.stderr
    return folder


def test_an_unchanged_program_passes(stored: Path) -> None:
    done = told(stored, "regress", "--baseline", "base")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "0 worse" in done.stdout


def test_the_baseline_says_where_it_comes_from(stored: Path) -> None:
    made, cases = baseline.load(stored / "base")
    assert {"git_commit", "casadi_version", "cpu", "started_at"} <= made.keys()
    assert made["threads"] == 1
    assert len(cases["small"]["ratios"]) == 5


def test_a_planted_slow_down_is_caught(stored: Path) -> None:
    slow = ["~solver", "+solver._target_=slow_solver.Slow"]
    done = told(stored, "regress", "--baseline", "base", *slow, PYTHONPATH=str(Path(__file__).parent))
    assert done.returncode == 1, done.stdout + done.stderr
    last = done.stdout.splitlines()[-1]
    assert last.startswith("small: solve / reference was ")
    assert float(last.rpartition("(+")[2].removesuffix("%)")) > 50.0


def test_a_planted_loss_of_travel_time_is_caught(stored: Path) -> None:
    best = baseline.load(stored / "base")[1]["small"]["travel_time_s"]
    slower = f"scenario.travel_time=[{1.02 * best},20]"  # no faster plan is allowed
    done = told(stored, "regress", "--baseline", "base", slower)
    assert done.returncode == 1, done.stdout + done.stderr
    assert any(x.startswith("small: travel_time_s was ") and "+2.0%" in x for x in done.stdout.splitlines())


@pytest.mark.parametrize(
    ("now", "worse"),
    [
        ({}, []),
        ({"travel_time_s": 2.009}, []),
        ({"travel_time_s": 2.011}, ["travel_time_s"]),
        ({"travel_time_s": 1.0, "iterations": 10}, []),
        ({"status": "uncertified", "certified": False}, ["status"]),
        ({"travel_time_s": None, "objective": None}, ["travel_time_s", "objective"]),
        ({"iterations": 134}, ["iterations"]),
        ({"evaluations": 666}, ["evaluations"]),
        ({"ratios": [2.0, 2.1, 2.05, 1.9, 2.2]}, ["solve / reference"]),
        ({"ratios": [1.4, 1.45, 1.4, 1.42, 1.41]}, []),
        ({"ratios": [1.0, 9.0, 1.0, 9.0, 9.0]}, []),  # an outlier or three are no confidence
    ],
)
def test_gates(now: dict[str, Any], worse: list[str]) -> None:
    changes = compare("case", WAS, WAS | now, Gates())
    assert [change.what for change in changes if change.verdict == "WORSE"] == worse


def test_gains_are_told() -> None:
    was = WAS | {"status": "uncertified", "certified": False}
    now = WAS | {"travel_time_s": 1.9, "ratios": [0.4, 0.41, 0.4, 0.39, 0.42]}
    better = [change.what for change in compare("case", was, now, Gates()) if change.verdict == "better"]
    assert better == ["status", "travel_time_s", "solve / reference"]


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("cases: {}", "cases"),
        ("cases: {a: [x]}\nrepeats: 2", "repeats"),
        ("cases: {a: [x]}\ngates: {solve_factor: 0.5}", "gates.solve_factor"),
        ("cases: {a: [x]}\nspeed: 1", "speed"),
        ("cases: [", "YAML"),
    ],
)
def test_a_bad_matrix_is_refused(tmp_path: Path, text: str, named: str) -> None:
    (tmp_path / "matrix.yaml").write_text(text)
    with pytest.raises(BadInput, match=named):
        Matrix.load(tmp_path)


def test_bad_calls_are_explained(stored: Path, tmp_path: Path) -> None:
    assert_refused(told(tmp_path, "regress", "--base", "x"), "benchbench regress", "--base")
    none = told(tmp_path, "regress")
    assert none.returncode == 2
    assert "--baseline" in none.stderr and "matrix.yaml" in none.stderr
    shutil.copy(stored / "base" / "matrix.yaml", tmp_path)
    early = told(tmp_path, "regress", "--baseline", ".")
    assert early.returncode == 2
    assert "--update" in early.stderr
    (tmp_path / "baseline.json").write_text("{")
    assert told(tmp_path, "regress", "--baseline", ".").returncode == 2
    content = json.loads((stored / "base" / "baseline.json").read_text())
    content["cases"]["small"]["ratios"] = []
    (tmp_path / "baseline.json").write_text(json.dumps(content))
    broken = told(tmp_path, "regress", "--baseline", ".")
    assert broken.returncode == 2
    assert "ratios" in broken.stderr
    content = json.loads((stored / "base" / "baseline.json").read_text())
    content["cases"]["small"]["travel_time_s"] = float("nan")  # nothing is worse than that
    (tmp_path / "baseline.json").write_text(json.dumps(content))
    unknown = told(tmp_path, "regress", "--baseline", ".")
    assert unknown.returncode == 2
    assert "cases.small.travel_time_s" in unknown.stderr
    unknown = told(stored, "regress", "--baseline", "base", "relaxation=nonsense")
    assert unknown.returncode == 2
    assert "nonsense" in unknown.stderr
