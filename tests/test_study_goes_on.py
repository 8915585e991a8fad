"""A study that is resumed: other choices are told in our words, trials that died are over, nothing found is no success."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import optuna
import pytest
from optuna.trial import TrialState
from program import assert_refused, told

from benchbench.ground.errors import BadInput
from benchbench.storage.schema import make_record
from benchbench.sweep.tuning import outcome
from benchbench.sweep.tuning.begun import bury, check_same
from benchbench.sweep.tuning.search import search
from benchbench.sweep.tuning.space import read
from benchbench.sweep.tuning.task import StudySettings

OVER = ("scenario", "seed")
PROBLEM = "+scenario=static,circle"


def settings(folder: Path, **asked: Any) -> StudySettings:
    usual = {"study_name": "tune", "n_trials": 2, "sampler": "random", "seed": 0, "prune": False,
             "objectives": ["travel_time_s"], "storage": f"sqlite:///{folder / 'study.db'}"}  # fmt: skip
    return StudySettings.of(**{**usual, **asked})


def flown(**columns: Any) -> Any:
    """What carries out runs, each with these columns in its record."""

    def plan(trial: int, runs: Sequence[Sequence[str]]) -> list[Mapping[str, Any] | None]:
        return [
            make_record(**{"certified": True, "status": "certified", "travel_time_s": 2.0, **columns})
            for _ in runs
        ]

    return plan


def begun(folder: Path, *arguments: str, **columns: Any) -> optuna.Study:
    """A study with two trials."""
    task = settings(folder)
    study, space = task.open(), read(arguments, OVER)
    check_same(study, space)
    search(task, study, space, flown(**columns), lambda text: None, folder)
    return study


@pytest.mark.parametrize(
    ("arguments", "field", "says"),
    [
        (("scenario.intervals=20,22,24", PROBLEM), "scenario.intervals", "begun with the choices 20, 22, and now the choices 20, 22, 24"),
        (("scenario.intervals=interval(20,22)", PROBLEM), "scenario.intervals", "and now numbers from 20.0 to 22.0 are asked for"),
        (("scenario.intervals=20,22", "dynamics=rk4,verlet", PROBLEM), "hydra.sweeper.study_name", "tunes scenario.intervals, and now"),
        (("scenario.intervals=20,22", "+scenario=static"), "hydra.sweeper.study_name", "begun with other problems: +scenario=circle, +scenario=static"),
        (("scenario.intervals=20,22", PROBLEM, "accuracy=low"), "hydra.sweeper.study_name", "begun with other fixed: none"),
    ],
)  # fmt: skip
def test_another_study_of_that_name_is_told_in_our_words(
    arguments: tuple[str, ...], field: str, says: str, tmp_path: Path
) -> None:
    study = begun(tmp_path, "scenario.intervals=20,22", PROBLEM)
    with pytest.raises(BadInput) as caught:
        check_same(settings(tmp_path).open(), read(arguments, OVER))
    assert caught.value.field == field and says in str(caught.value)
    assert "another hydra.sweeper.study_name" in str(caught.value)
    assert len(study.trials) == 2
    check_same(study, read(("scenario.intervals=20,22", PROBLEM, "workers=2", "hydra.verbose=true"), OVER))


def test_the_command_tells_it(tmp_path: Path) -> None:
    folder = tmp_path / "results" / "tune" / "tune"
    folder.mkdir(parents=True)
    begun(folder, "scenario.intervals=20,22", "+scenario=choice(static)")
    again = (
        "-m",
        "hydra/sweeper=optuna",
        "+scenario=choice(static)",
        "scenario.intervals=20,24",
        "hydra.sweeper.objectives=[travel_time_s]",
    )
    assert_refused(told(tmp_path, *again), "scenario.intervals", "the choices 20, 22")


def test_a_trial_that_is_left_unfinished_fails(tmp_path: Path) -> None:
    task = settings(tmp_path)
    study, space = task.open(), read(("scenario.intervals=20,22",), OVER)

    def stopped(trial: int, runs: Sequence[Sequence[str]]) -> list[Mapping[str, Any] | None]:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        search(task, study, space, stopped, print, tmp_path)
    assert [trial.state for trial in study.trials] == [TrialState.FAIL]


DYING = """
import sys
from pathlib import Path
sys.path.insert(0, sys.argv[2])
from benchbench.sweep.tuning.begun import at_work
from test_study_goes_on import settings
trial = settings(Path(sys.argv[1])).open().ask()
with at_work(trial, Path(sys.argv[1])):
    print(flush=True)
    sys.stdin.read()
"""


def test_trials_of_a_dead_process_are_over_and_those_of_a_living_one_are_not(tmp_path: Path) -> None:
    study = settings(tmp_path).open()
    command = [sys.executable, "-c", DYING, str(tmp_path), str(Path(__file__).parent)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as other:
        assert other.stdout is not None and other.stdout.readline()
        assert bury(study, tmp_path) == 0
        other.kill()
    assert bury(study, tmp_path) == 1 and bury(study, tmp_path) == 0
    assert [trial.state for trial in study.trials] == [TrialState.FAIL]
    elsewhere = study.ask()
    elsewhere.set_user_attr("host", "another machine")
    assert bury(study, tmp_path) == 0, "what another machine is at cannot be known here"


def test_a_study_in_which_nothing_finite_was_found_has_no_best(tmp_path: Path) -> None:
    study = begun(tmp_path, "scenario.intervals=20,22", travel_time_s=None)
    assert [trial.user_attrs["uncertified"] for trial in study.trials] == [1, 1]
    assert outcome.front(study) == []
    assert "best" not in outcome.write(study, ("travel_time_s",), tmp_path, ())
