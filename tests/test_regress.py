"""`benchbench regress`, as CI runs it: planted losses are found, and nothing else is."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pytest
from program import assert_refused, told
from sharing import Once

from benchbench.cli.commands import regress
from benchbench.flight import extra
from benchbench.ground.errors import BadInput
from benchbench.sweep.regression import baseline
from benchbench.sweep.regression.compare import Change, compare, unavailable
from benchbench.sweep.regression.matrix import Gates, Matrix

CASE = "[+scenario=static, strategy=phases, strategy.margin=0, scenario.intervals=12]"
MATRIX = f"common: [compile=never]\nrepeats: 5\ncases:\n  small: {CASE}\n"
WAS: dict[str, Any] = {
    "status": "certified", "certified": True, "travel_time_s": 2.0, "objective": 2.1, "iterations": 100,
    "evaluations": 500, "ratios": [1.0, 1.02, 0.98, 1.01, 0.99],
}  # fmt: skip


@pytest.fixture(scope="module")
def stored(once: Once) -> Path:
    """A baseline of one small case; to compare with it writes nothing."""
    return once("regress", measured)


def measured(folder: Path) -> None:
    (folder / "base").mkdir()
    (folder / "base" / "matrix.yaml").write_text(MATRIX)
    done = told(folder, "regress", "--baseline", "base", "--update")
    assert done.returncode == 0, done.stderr


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


def changes(was: dict[str, Any], now: dict[str, Any], **gates: float) -> dict[str, Change]:
    found = compare("a case", WAS | was, WAS | was | now, Gates(**gates))
    assert {change.case for change in found} == {"a case"}
    return {change.what: change for change in found}


def test_every_line_tells_what_was_and_is() -> None:
    now = {"travel_time_s": 2.005, "iterations": 110, "ratios": [1.1, 1.2, 1.3, 1.15, 1.25]}
    found = changes({}, now)
    told = {what: (c.was, c.now, c.verdict) for what, c in found.items()}
    assert told == {
        "status": ("certified", "certified", "same"), "travel_time_s": ("2", "2.005", "same"),
        "objective": ("2.1", "2.1", "same"), "iterations": ("100", "110", "same"), "evaluations": ("500", "500", "same"),
        "solve / reference": ("1.000", "1.200", "same"),
    }  # fmt: skip
    moved = {what: c.change for what, c in found.items() if c.moved}
    assert moved == pytest.approx({"travel_time_s": 0.0025, "iterations": 0.1, "solve / reference": 0.2})
    assert (found["status"].change, found["objective"].change) == (None, 0.0)
    assert "+0.5%" in found["travel_time_s"].note and "+30.0%" in found["iterations"].note
    assert "factor 1.5 " in found["solve / reference"].note
    lost = changes({}, {"status": "infeasible", "certified": False})["status"]
    assert (lost.was, lost.now, lost.change, lost.moved) == ("certified", "infeasible", None, True)


@pytest.mark.parametrize(
    ("what", "old", "new", "verdict", "change"),
    [
        ("objective", 200.0, 201.0, "same", 0.005),
        ("objective", 200.0, 201.01, "WORSE", 0.00505),
        ("objective", 200.0, 199.0, "same", -0.005),
        ("objective", 200.0, 198.99, "better", -0.00505),
        ("objective", -200.0, -199.0, "same", 0.005),
        ("objective", -200.0, -190.0, "WORSE", 0.05),
        ("objective", -200.0, -210.0, "better", -0.05),
        ("objective", 0.0, 0.0, "same", None),
        ("objective", 0.0, 0.001, "WORSE", None),
        ("objective", 0.0, -0.001, "better", None),
        ("iterations", 100, 133, "same", 0.33),
        ("iterations", 100, 134, "WORSE", 0.34),
        ("iterations", 100, 67, "same", -0.33),
        ("iterations", 100, 66, "better", -0.34),
        ("iterations", 1, 4, "same", 3.0),
        ("evaluations", 500, 665, "same", 0.33),
        ("evaluations", 500, 666, "WORSE", 0.332),
        ("evaluations", 500, 334, "better", -0.332),
        ("travel_time_s", None, None, "same", None),
        ("travel_time_s", None, 2.0, "better", None),
        ("travel_time_s", 2.0, None, "WORSE", None),
    ],
)
def test_a_gate_opens_at_its_share_and_no_sooner(
    what: str, old: float | None, new: float | None, verdict: str, change: float | None
) -> None:
    """Of what it was, without its sign; counts may rise by 3 iterations and 15 evaluations besides."""
    found = changes({what: old}, {what: new})[what]
    assert found.verdict == verdict
    assert found.change == (None if change is None else pytest.approx(change))
    spoken = ["none" if number is None else f"{number:g}" for number in (old, new)]
    assert [found.was, found.now] == spoken
    assert found.moved == (old != new)


@pytest.mark.parametrize(
    ("factor", "gates", "verdict"),
    [
        (1.4, {}, "same"),
        (1.6, {}, "WORSE"),
        (1.6, {"solve_factor": 1.7}, "same"),
        (1.6, {"confidence": 0.999}, "same"),  # five runs of each cannot tell so surely
        (0.7, {}, "same"),
        (0.6, {}, "better"),
        (0.6, {"solve_factor": 1.8}, "same"),
        (0.6, {"confidence": 0.999}, "same"),
    ],
)
def test_solve_time_is_compared_by_its_ranks(factor: float, gates: dict[str, float], verdict: str) -> None:
    """All of five above all of five others has probability 1 / 252 by chance."""
    now = [factor * ratio for ratio in WAS["ratios"]]
    found = changes({}, {"ratios": now}, **gates)["solve / reference"]
    assert found.verdict == verdict
    assert found.change == pytest.approx(factor - 1.0)
    assert f"p = {1 / 252 if factor == 1.6 and 'solve_factor' not in gates else 1:.2g} " in found.note


def test_solve_time_is_relative_to_what_it_was() -> None:
    """Four seconds or a quarter of one, half as much again and more: the same verdict."""
    for scale in (4.0, 0.25):
        was = [scale * ratio for ratio in WAS["ratios"]]
        for factor, verdict in ((1.6, "WORSE"), (1.2, "same"), (0.6, "better")):
            found = changes({"ratios": was}, {"ratios": [factor * ratio for ratio in was]})[
                "solve / reference"
            ]
            assert found.verdict == verdict and found.change == pytest.approx(factor - 1.0)


def test_a_chance_as_large_as_the_level_proves_nothing() -> None:
    """One run above three others has probability 1 / 4 by chance."""
    for now, surer in ((10.0, "WORSE"), (0.1, "better")):
        for confidence, verdict in ((0.75, "same"), (0.74, surer)):
            found = changes({"ratios": [1.0, 1.01, 1.02]}, {"ratios": [now]}, confidence=confidence)
            assert found["solve / reference"].verdict == verdict


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


FLOWN: dict[str, Any] = {
    "flights": 3, "flights_succeeded": 3, "flight_error_before_m": 0.006, "flight_error_after_m": 0.008,
}  # fmt: skip


@pytest.mark.parametrize(
    ("now", "verdicts"),
    [
        ({}, ("same", "same", "same")),
        ({"flights_succeeded": 2}, ("WORSE", "same", "same")),
        ({"flight_error_before_m": 0.0065}, ("same", "same", "same")),
        ({"flight_error_before_m": 0.0067}, ("same", "WORSE", "same")),
        ({"flight_error_after_m": 0.007}, ("same", "same", "better")),
        ({"flight_error_after_m": None}, ("same", "same", "WORSE")),
        (
            {"flights": 4, "flights_succeeded": 4},
            ("WORSE", "same", "same"),
        ),  # not the flights that were stored
        (
            {"flights": None, "flights_succeeded": None},
            ("WORSE", "same", "same"),
        ),  # no longer certified, so not flown
    ],
)
def test_flights_are_counted_exactly_and_tracked_within_their_gate(
    now: dict[str, Any], verdicts: tuple[str, ...]
) -> None:
    found = compare("flown", FLOWN, FLOWN | now, Gates())
    assert tuple(change.verdict for change in found) == verdicts
    assert [change.what for change in found] == ["flights", "flight_error_before_m", "flight_error_after_m"]
    assert compare("flown", FLOWN | {"flights_succeeded": 1}, FLOWN, Gates())[0].verdict == "better"


def test_flights_without_their_extra_are_told_and_no_regression(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = ["+scenario=static", "flights=1"]
    matrix = Matrix(cases={"flown": asked}, common=["compile=never"])
    monkeypatch.setattr(extra, "find_spec", lambda module: None)
    entries, missing = regress._measure_all(matrix, [])
    assert not entries and "pip install 'benchbench[flight]'" in missing["flown"]
    change = unavailable("flown", FLOWN, missing["flown"])
    assert (change.was, change.now, change.verdict) == ("3 of 3", "unavailable", "same") and change.moved


def test_the_baseline_that_is_shipped_holds_flights() -> None:
    folder = Path(__file__).resolve().parents[1] / "references" / "baseline"
    _, cases = baseline.load(folder)
    assert set(cases) == set(Matrix.load(folder).cases)
    assert [name for name, entry in cases.items() if "flights" in entry] == ["circle flights nmpc"]
