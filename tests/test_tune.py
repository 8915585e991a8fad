"""Tuning as a user does it: small studies, resumed, shared, and what they leave behind."""

from __future__ import annotations

import os
import secrets
import subprocess
import sys
from pathlib import Path

import optuna
import pandas as pd
import pytest
from program import records, told
from sweeps import path_with_bad_runs

from benchbench.cli.commands import tune
from benchbench.ground.errors import BadInput, Pruned
from benchbench.run import config, flying, pipeline
from benchbench.run.progress import LiveLine
from benchbench.sweep.tuning import outcome, search
from benchbench.sweep.tuning.space import read
from benchbench.sweep.tuning.steps import TrialReport
from benchbench.sweep.tuning.storage import opened
from benchbench.sweep.tuning.task import StudySettings

EXAMPLE = Path(__file__).parents[1] / "examples" / "tuning" / "schedule.yaml"
FLOWN = ("strategy=phases", "strategy.margin=0", "dynamics=collocation")
SMALL = ("+scenario=static,linear", *FLOWN, "scenario.intervals=20,22")
OPTUNA = ("-m", "hydra/sweeper=optuna", "hydra.sweeper.sampler=random", "picture=false", "workers=1")


def study(folder: Path, name: str = "tune") -> optuna.Study:
    return optuna.load_study(study_name=name, storage=f"sqlite:///{folder}/results/tune/{name}/study.db")


@pytest.mark.slow
def test_a_study_ends_with_a_configuration_that_runs_and_goes_on(tmp_path: Path) -> None:
    first = told(tmp_path, *OPTUNA, *SMALL, "hydra.sweeper.n_trials=2")
    assert first.returncode == 0, first.stdout + first.stderr
    assert "Pareto front" in first.stdout
    folder = tmp_path / "results" / "tune" / "tune"
    assert (folder / "front.png").read_bytes().startswith(b"\x89PNG")
    trials = study(tmp_path).trials
    found = {r["run_id"]: r for r in records(tmp_path)}
    for trial in trials:  # the objectives are the sums over both scenarios
        of_trial = [r for key, r in found.items() if f"trials_{trial.number}_" in key]
        assert sorted(r["scenario"] for r in of_trial) == ["linear", "static"]
        assert trial.values[0] == pytest.approx(sum(r["travel_time_s"] for r in of_trial), abs=1e-12)
        assert trial.values[1] == pytest.approx(sum(r["solve_cpu_s"] for r in of_trial), abs=1e-12)
    best = pd.read_csv(folder / "front.csv").iloc[0]
    tuned = told(
        tmp_path,
        "--config-dir",
        str(folder),
        "+scenario=static",
        "+tuned=best",
        "output=again",
        "picture=false",
    )
    assert tuned.returncode == 0, tuned.stdout + tuned.stderr
    (record,) = records(tmp_path / "again")
    assert (record["strategy"], record["dynamics"]) == ("phases", "collocation")
    assert record["intervals"] == best["scenario.intervals"]
    again = told(tmp_path, *OPTUNA, *SMALL, "hydra.sweeper.n_trials=1")
    assert "goes on after 2 trials" in again.stdout
    assert len(study(tmp_path).trials) == 3


DATABASE = os.environ.get("BENCHBENCH_TEST_DATABASE", "")
needs_database = pytest.mark.skipif(not DATABASE, reason="BENCHBENCH_TEST_DATABASE names no database")


@pytest.mark.slow
@pytest.mark.parametrize(
    "storage",
    [
        "sqlite:///{}/shared.db",
        "journal:{}/shared.log",
        pytest.param(DATABASE, marks=needs_database, id="server"),
    ],
)
def test_processes_share_a_study(tmp_path: Path, storage: str) -> None:
    url, name = storage.format(tmp_path), f"shared-{secrets.token_hex(4)}"
    where = [f"hydra.sweeper.storage='{url}'", f"hydra.sweeper.study_name={name}"]
    command = [
        sys.executable, "-m", "benchbench", *OPTUNA, "+scenario=static", "strategy=phases", "strategy.margin=0",
        "scenario.intervals=12,13,14", "hydra.sweeper.n_trials=1", *where, "hydra.sweeper.seed=null",
    ]  # fmt: skip
    both = [
        subprocess.Popen(
            command, cwd=tmp_path, env={**os.environ, "OMP_NUM_THREADS": "1"}, stdout=subprocess.DEVNULL
        )
        for _ in range(2)
    ]
    assert [process.wait(200) for process in both] == [1, 1]  # so coarse a grid is never certified
    kept = opened(url)
    kept = optuna.storages.RDBStorage(kept) if isinstance(kept, str) else kept
    trials = optuna.load_study(study_name=name, storage=kept).trials
    if isinstance(kept, optuna.storages.RDBStorage):
        kept.remove_session()
        kept.engine.dispose()
    assert sorted(t.number for t in trials) == [0, 1]
    assert all(t.user_attrs["uncertified"] == 1 for t in trials)


def test_a_crash_costs_a_trial_and_is_not_good(tmp_path: Path) -> None:
    done = told(
        tmp_path, *OPTUNA, "+scenario=static", "~strategy", "+strategy._target_=bad_runs.Bad", "scenario.intervals=12",
        "+strategy.how=segfault,exit", "hydra.sweeper.n_trials=2", "hydra.sweeper.objectives=[travel_time_s]",
        PYTHONPATH=path_with_bad_runs(),
    )  # fmt: skip
    assert done.returncode == 1, done.stdout + done.stderr
    assert "no trial has all its plans certified" in done.stdout
    assert [t.user_attrs["uncertified"] for t in study(tmp_path).trials] == [1, 1]


def test_a_bad_trial_is_pruned_after_a_problem(tmp_path: Path) -> None:
    space = (
        "+scenario=static,linear",
        *FLOWN,
        "scenario.intervals=choice(8,20)",
    )
    done = told(
        tmp_path, *OPTUNA, *space, "hydra.sweeper.n_trials=2", "hydra.sweeper.objectives=[travel_time_s]",
        "hydra.sweeper.prune=true", "hydra.sweeper.seed=0",
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    trials = [(t.params["scenario.intervals"], t.state.name) for t in study(tmp_path).trials]
    assert trials == [("20", "COMPLETE"), ("8", "PRUNED")]
    assert len(records(tmp_path)) == 3


def good_trial(made: optuna.Study, value: float) -> None:
    made.add_trial(optuna.trial.create_trial(value=value, user_attrs={"uncertified": 0}))


def reported(made: optuna.Study, url: str, schedule: str) -> tuple[dict[int, float], int | None]:
    """A run that reports to a new trial: its reports, and its iterations unless it was given up."""
    asked = (
        "+scenario=static", "scenario.intervals=12", "compile=never", f"relaxation.schedule={schedule}", "strategy=relax",
        "strategy.margin=0",  # one homotopy, whatever its certificate says
    )  # fmt: skip
    trial = made.ask()
    report = TrialReport(url, made.study_name, trial.number, "iterations", problem=1, before=1000.0)
    try:
        done = pipeline.run(config.compose(*asked), LiveLine(report)).record["iterations"]
    except Pruned:
        done = None
    found = made.trials[trial.number].intermediate_values
    made.tell(trial, state=optuna.trial.TrialState.PRUNED)
    return found, done


def test_a_run_is_given_up_between_two_steps_of_its_homotopy(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path}/study.db"
    made = optuna.create_study(study_name="steps", storage=url)
    free, iterations = reported(made, url, "[1e-2,1e-4,1e-6]")
    assert list(free) == [1000, 1001, 1002]  # no guess among them
    assert list(free.values()) == sorted(free.values()) and free[1002] == 1000.0 + (iterations or 0)
    good_trial(made, free[1001] - 1.0)
    assert reported(made, url, "[1e-2,1e-4,1e-6]") == ({k: free[k] for k in (1000, 1001)}, None)
    good_trial(made, free[1000] - 1.0)
    assert reported(made, url, "[1e-2,1e-4,1e-6]") == ({1000: free[1000]}, None)


def test_pruned_runs_of_a_study_are_told_and_stored_as_such(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path}/it's.db"
    made = optuna.create_study(study_name="tune", storage=url)
    made.set_user_attr("objectives", ["iterations"])
    good_trial(made, 1.0)
    done = told(
        tmp_path, *OPTUNA, "+scenario=static,linear", "scenario.intervals=12,13", "relaxation.schedule=[1e-2,1e-6]",
        "hydra.sweeper.objectives=[iterations]", "hydra.sweeper.n_trials=1", "hydra.sweeper.prune=steps",
        f'hydra.sweeper.storage="{url}"',
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr  # the good trial is the best
    assert "trial 1: pruned in problem 1: scenario.intervals=" in done.stdout and done.stderr == ""
    trial = made.trials[1]
    assert trial.state == optuna.trial.TrialState.PRUNED and list(trial.intermediate_values) == [0]
    (record,) = records(tmp_path)
    assert record["status"] == "pruned" and "more than the best trial needs" in record["reasons"][0]


def test_the_front_has_what_nobody_beats() -> None:
    made = optuna.create_study(directions=["minimize", "minimize"])
    for values, bad in [((1.0, 3.0), 0), ((2.0, 2.0), 0), ((2.0, 2.5), 0), ((0.5, 0.5), 1), ((3.0, 1.0), 0)]:
        made.add_trial(optuna.trial.create_trial(values=values, user_attrs={"uncertified": bad}))
    assert [t.values for t in outcome.front(made)] == [[1.0, 3.0], [2.0, 2.0], [3.0, 1.0]]


@pytest.mark.parametrize(
    ("fixed", "strategy"), [((), "relax"), (("strategy=polish",), "polish"), (("seed=1",), "relax")]
)
def test_the_best_configuration_holds_what_its_overrides_imply(
    fixed: tuple[str, ...], strategy: str, tmp_path: Path
) -> None:
    """The runs of a study that tunes a relaxation use one; so must the file, where nothing is implied."""
    (tmp_path / "tuned").mkdir()
    text = outcome.as_config({"relaxation.schedule": "[1e-3]"}, fixed, "s", ("+scenario=static",))
    (tmp_path / "tuned" / "best.yaml").write_text(text)
    case = config.compose("+scenario=circle", "+tuned=best", f"hydra.searchpath=['file://{tmp_path}']")
    assert case.names["strategy"].partition("(")[0] == strategy
    assert case.names["scenario"] == "circle" and list(case.relaxation.schedule) == [1e-3]


def test_the_best_configuration_flies_as_its_study_did(tmp_path: Path) -> None:
    """Choices of flights, of their judge and of a contact stay choices."""
    (tmp_path / "tuned").mkdir()
    fixed = ("+scenario/contact=approach", "flights=3", "residual=observer", "mismatch=windy")
    params = {"residual.gain": 0.2, "scenario.contacts.approach.slope": 3.5}
    (tmp_path / "tuned" / "best.yaml").write_text(
        outcome.as_config(params, fixed, "s", ("+scenario=static",))
    )
    cfg, chosen = config.composed(
        "+scenario=circle", "+tuned=best", f"hydra.searchpath=['file://{tmp_path}']"
    )
    said, _ = config.composed(
        "+scenario=circle", *fixed, *(f"{key}={value}" for key, value in params.items())
    )
    assert cfg == said and chosen["mismatch"] == "windy"
    assert flying.campaign(cfg, chosen) is not None
    more, _ = config.composed(
        "+scenario=circle", "+tuned=best", "flights=20", f"hydra.searchpath=['file://{tmp_path}']"
    )
    assert more == {**cfg, "flights": 20}  # what the file says of flights stands


def test_more_successes_are_asked_for_with_a_minus() -> None:
    record = {"certified": True, "flights_succeeded": 4, "travel_time_s": 3.0}
    asked = StudySettings.of("s", "sqlite://", 1, ("-flights_succeeded", "travel_time_s"), "tpe", 0, None)
    assert [search.cost(record, name) for name in asked.objectives] == [-4.0, 3.0]


def test_hydras_syntax_becomes_distributions() -> None:
    space = read(
        ["a=interval(1.0,2.0)", "b=tag(log,interval(1e-4,1e-1))", "c=int(interval(2,9))", "d=x,y", "s=1,2", "+e=3", "f=range(1,7,2)"],
        over=("s",),
    )  # fmt: skip
    assert space.tuned["a"] == optuna.distributions.FloatDistribution(1.0, 2.0)
    assert space.tuned["b"] == optuna.distributions.FloatDistribution(1e-4, 1e-1, log=True)
    assert space.tuned["c"] == optuna.distributions.IntDistribution(2, 9)
    assert space.tuned["d"] == optuna.distributions.CategoricalDistribution(("x", "y"))
    assert space.tuned["f"] == optuna.distributions.CategoricalDistribution(("1", "3", "5"))
    assert space.problems == (("s=1",), ("s=2",))
    assert space.fixed == ("+e=3",)


def test_a_file_says_the_same_as_the_command_line() -> None:
    said = tune.overrides(EXAMPLE)
    assert "hydra/sweeper=optuna" in said
    assert "hydra.sweeper.over=[scenario]" in said
    assert "+scenario=choice(static,linear)" in said
    space = read([s for s in said if not s.startswith("hydra")], ("scenario",))
    assert len(space.problems) == 2
    assert "[1e-06]" in space.tuned["relaxation.schedule"].choices  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("scenario.intervals=20",), "no field is to be tuned"),
        (("scenario.intervals=interval(30,20)",), "scenario.intervals"),
        (("scenario.interval=20,30",), "scenario.interval"),
        (("scenario.intervals=20,30", "hydra.sweeper.objectives=[beauty]"), "hydra.sweeper.objectives"),
        (
            ("scenario.intervals=20,30", "hydra.sweeper.objectives=[flights_succeeded]"),
            "hydra.sweeper.objectives",
        ),
        (("scenario.intervals=20,30", "hydra.sweeper.sampler=guess"), "hydra.sweeper.sampler"),
        (("scenario.intervals=20,30", "hydra.sweeper.storage=nowhere://x"), "hydra.sweeper.storage"),
        (("scenario.intervals=20,30", "hydra.sweeper.n_trials=0"), "hydra.sweeper.n_trials"),
        (("scenario.intervals=20,30", "hydra.sweeper.seed=-1"), "hydra.sweeper.seed"),
        (("scenario.intervals=20,30", "hydra.sweeper.prune=true"), "hydra.sweeper.prune"),
        (
            ("scenario.intervals=20,30", "hydra.sweeper.prune=steps", "hydra.sweeper.objectives=[wall_s]"),
            "hydra.sweeper.prune",
        ),
    ],
)
def test_bad_input(tmp_path: Path, arguments: tuple[str, ...], said: str) -> None:
    done = told(tmp_path, *OPTUNA, "+scenario=static", *arguments)
    assert done.returncode == 2, done.stdout + done.stderr
    assert said in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("text", "told"), [("a: 1", "space"), ("space: {a: 1}\nspeed: 2", "speed"), ("space: [", "YAML")]
)
def test_a_bad_file_is_refused(tmp_path: Path, text: str, told: str) -> None:
    path = tmp_path / "space.yaml"
    path.write_text(text)
    with pytest.raises(BadInput, match=told):
        tune.overrides(path)
    with pytest.raises(BadInput, match="cannot be read"):
        tune.overrides(tmp_path / "none.yaml")
