"""Suites: what they are, what a method did on them, and the command as a user calls it."""

from __future__ import annotations

import json
import math
import re
import shlex
from pathlib import Path
from typing import Any

import pytest
import yaml
from program import records, told

from benchbench.analysis.suite import cpu, outcome
from benchbench.ground.errors import BadInput
from benchbench.run import config
from benchbench.run.suites import Suite, suite, suites
from benchbench.storage.schema import make_record

SUITES = {"handover100": 100, "hardware30": 30, "race50": 50, "delivery20": 20}
TINY = {"title": "three tasks", "version": 2, "scenario": "random_handover", "seeds": [1, 3]}
PLAIN = ("strategy=phases", "strategy.margin=0", "dynamics=midpoint")
QUICK = ("scenario.intervals=14", "scenario.kappa_init=1", *PLAIN)


def write(folder: Path, **changes: Any) -> str:
    path = folder / "tiny.yaml"
    path.write_text(json.dumps(TINY | {"fixed": ["picture=false", "workers=1"]} | changes))
    return str(path)


def row(certified: bool = True, **columns: Any) -> dict[str, Any]:
    status = "certified" if certified else "uncertified"
    usual = {
        "build_cpu_s": 0.5,
        "solve_cpu_s": 1.0,
        "certificate_cpu_s": 0.5,
        "travel_time_s": 3.0,
        "task_hash": "a",
    }
    return make_record(**{"status": status, "certified": certified, **usual, **columns})


def test_there_are_the_suites_that_the_issue_names() -> None:
    assert {name: suite(name)[1].count(False) for name in suites()} == SUITES | {"classics": 9}
    quick = {n: k // 10 for n, k in SUITES.items()} | {"classics": 1}
    assert {name: suite(name)[1].count(True) for name in suites()} == quick


def test_a_suite_may_be_scenarios_by_name(tmp_path: Path) -> None:
    """They are no flights: what is least is their objective, and there is no proven bound."""
    file = write(tmp_path, scenario=["block_move", "double_integrator"], seeds=None)
    assert suite(file)[1].overrides([], quick=True)[0] == "+scenario=block_move"
    done = told(tmp_path, "suite", file, "scenario.intervals=20")
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.search(r"objective +median \+0 %, worst \+0 % above the best known of 2 tasks", done.stdout)
    assert "travel time" not in done.stdout and "proven bound" not in done.stdout


@pytest.mark.parametrize("name", SUITES)
def test_a_suite_is_a_sweep_over_a_family(name: str) -> None:
    chosen = suite(name)[1]
    told = chosen.overrides(["dynamics=rk4", "picture=true"])
    assert told == [
        f"+scenario={chosen.scenario}",
        f"seed=range(1,{SUITES[name] + 1})",
        "dynamics=rk4",
        "picture=true",
    ]
    assert chosen.scenario.startswith("random_") and chosen.scenario in config.choices("scenario")


@pytest.mark.parametrize("typed", ["seed=3", "+scenario=circle", "scenario.family.seed=3"])
def test_other_tasks_are_no_suite(typed: str) -> None:
    with pytest.raises(
        BadInput, match=r"is what a suite says; allowed: a sweep, -m \+scenario=random_handover"
    ):
        suite("handover100")[1].overrides([typed])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"seeds": [3, 1]}, r"seeds: the first seed must not exceed the last"),
        ({"seeds": [-1, 1]}, r"seeds\.0: -1 was given"),
        ({"seed": 3}, r"seed: does not exist, perhaps 'seeds'"),
        ({"seeds": None}, r"seeds belong to a family"),
        ({"scenario": ["circle"]}, r"a list of scenarios has none"),
        ({"scenario": [], "seeds": None}, r"scenario"),
        ({"version": 0}, r"version: 0 was given"),
    ],
)
def test_a_bad_suite_is_one_message(tmp_path: Path, changes: dict[str, Any], message: str) -> None:
    with pytest.raises(BadInput, match=message):
        suite(write(tmp_path, **changes))


def test_what_is_no_suite_is_told(tmp_path: Path) -> None:
    (tmp_path / "no.yaml").write_text("{")
    (tmp_path / "list.yaml").write_text("[1]")
    for name, message in (("handover", "delivery20, handover100"), ("gone.yaml", "cannot be read")):
        with pytest.raises(BadInput, match=message):
            suite(name)
    for name, message in (("no.yaml", "is no YAML"), ("list.yaml", "is no suite")):
        with pytest.raises(BadInput, match=message):
            suite(str(tmp_path / name))


def test_a_task_that_is_not_certified_counts_whatever_became_of_it() -> None:
    found = outcome(
        [row(), row(), row(False), row(certified=False, status="timeout", solve_cpu_s=None), None]
    )
    assert (found.certified.successes, found.certified.runs) == (2, 5)
    assert found.certified.low == pytest.approx(0.1176, abs=1e-4)  # Wilson 1927, 2 of 5
    assert found.statuses == {"certified": 2, "uncertified": 1, "timeout": 1, "bad_input": 1}


def test_times_that_are_not_known_are_long_ones() -> None:
    rows = [row(solve_cpu_s=float(i)) for i in range(19)]
    assert outcome([*rows, None]).cpu_median_s == 1.0 + 9  # half of 20 tasks take 0 to 9 s of solve
    assert outcome([*rows, None]).cpu_most_s == 1.0 + 18  # 95 % of 20 tasks are 19
    assert outcome([*rows, None, None]).cpu_most_s is None
    assert outcome([row(), None, None]).cpu_median_s is None
    assert cpu(None) == math.inf and cpu(row()) == 2.0


def test_gaps_are_those_of_certified_plans() -> None:
    rows = [
        row(best_known_s=3.0, gap_percent=0.0, lower_bound_s=2.0), row(best_known_s=2.0, gap_percent=50.0, lower_bound_s=1.5),
        row(best_known_s=4.0, gap_percent=-25.0), row(), row(False, best_known_s=1.0, lower_bound_s=0.1),
    ]  # fmt: skip
    found = outcome(rows)
    assert (found.gap_median, found.gap_worst, found.compared) == (0.0, 50.0, 3)
    assert found.better == 2  # one beats the best known, one is the first
    assert (found.bound_median, found.bounded) == (pytest.approx(75.0), 2)


def test_an_empty_suite_of_answers_says_nothing() -> None:
    found = outcome([None])
    assert (found.cpu_median_s, found.gap_median, found.gap_worst, found.bound_median) == (None,) * 4


def test_a_suite_runs_goes_on_and_says_what_came_out(tmp_path: Path) -> None:
    file = write(tmp_path)
    first = told(tmp_path, "suite", file, *QUICK, "--quick")
    assert first.returncode == 1 and "a tenth of it" in first.stdout
    assert [r["scenario"] for r in records(tmp_path)] == ["random_handover_1"]
    sweep = told(
        tmp_path, "-m", "+scenario=random_handover", "seed=range(1,3)", *QUICK, "picture=false", "workers=1"
    )
    assert "1 of 2 runs are in the table" in sweep.stdout  # the same runs as those of a sweep
    whole = told(tmp_path, "suite", file, *QUICK)
    assert "2 of 3 runs are in the table" in whole.stdout and whole.returncode == 1
    assert re.search(
        r"certified +0 of 3 +\(95 % Wilson interval 0\.0 to 56\.1 %\); 3 uncertified", whole.stdout
    )
    path = Path(re.search(r"summary +(\S+)", whole.stdout)[1])  # type: ignore[index]
    assert path.parent == tmp_path / "results" / "suites"
    content = json.loads(path.read_text())
    assert (content["suite"], content["version"], content["quick"]) == ("tiny", 2, False)
    (method,) = content["methods"]
    assert method["method"] == list(QUICK)
    assert [t["scenario"] for t in method["tasks"]] == [f"random_handover_{seed}" for seed in (1, 2, 3)]
    for task, seed in zip(method["tasks"], (1, 2, 3), strict=True):
        line = next(line for line in whole.stdout.splitlines() if f"seed={seed} " in line and "#" in line)
        again, _, why = line.partition("  # uncertified: ")
        assert again == task["command"] and task["reasons"][0] in why
        case = config.compose(*shlex.split(again)[3:])
        assert case.task_hash == task["task_hash"]


def test_a_suite_compares_methods(tmp_path: Path) -> None:
    done = told(
        tmp_path,
        "suite",
        write(tmp_path, seeds=[1, 1]),
        "scenario.intervals=12,14",
        "scenario.kappa_init=1",
        *PLAIN,
    )
    (path,) = (tmp_path / "results" / "suites").glob("tiny_*.json")
    methods = json.loads(path.read_text())["methods"]
    assert [m["method"][0] for m in methods] == ["scenario.intervals=12", "scenario.intervals=14"]
    assert done.stdout.count("Wilson") == 2


def test_best_known_values_of_drawn_tasks_are_kept(tmp_path: Path) -> None:
    race = write(tmp_path, scenario="random_race", seeds=[3, 3])
    first = told(tmp_path, "suite", race, "scenario.nodes_per_gate=20")
    assert first.returncode == 0, first.stdout + first.stderr
    assert "1 of 1 " in first.stdout and "1 are the best known now" in first.stdout
    kept = told(tmp_path, "best", "results")
    assert "random_race_3, rk4, N = 80" in kept.stdout and "the first" in kept.stdout
    (entry,) = yaml.safe_load((tmp_path / "references" / "best_known.yaml").read_text())
    assert config.compose(*shlex.split(entry["command"])).task_hash == entry["task_hash"]
    again = told(tmp_path, "suite", race, "scenario.nodes_per_gate=20", "rerun=all")
    assert "median +0 %, worst +0 % above the best known of 1 tasks" in again.stdout
    assert "are the best known now" not in again.stdout


def test_suites_are_listed_with_ones_own(tmp_path: Path) -> None:
    (tmp_path / "suite").mkdir()
    write(tmp_path / "suite")
    done = told(tmp_path, "suite", "--config-dir", str(tmp_path))
    assert done.returncode == 0
    assert {line.split()[0] for line in done.stdout.splitlines()} == {*SUITES, "classics", "tiny"}
    assert "tiny         version 2, 3 tasks: three tasks" in done.stdout


def test_a_bad_call_ends_with_one_message(tmp_path: Path) -> None:
    for arguments in (("nosuch",), ("handover100", "seed=3"), ("handover100", "scenario.family.along=[2,1]")):
        done = told(tmp_path, "suite", *arguments)
        assert done.returncode == 2 and "Traceback" not in done.stderr
    assert "scenario.family.along: the first number" in done.stderr


def test_seeds_of_a_suite_are_whole_numbers() -> None:
    assert Suite(**TINY).overrides([], quick=True) == ["+scenario=random_handover", "seed=range(1,2)"]
