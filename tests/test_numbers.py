"""Numbers and words out of range, told before Hydra is imported: in the words of the run itself, and only where they are plain."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchbench.ground.errors import BadInput
from benchbench.run import config
from benchbench.run.choices import folder
from benchbench.run.numbers import check_at_once

PLACE = Path(folder()) / "scenario"
WRONG = (
    "seed=-1", "seed=0.5", "time_limit=0", "time_limit=ten", "iteration_limit=0", "accuracy=best", "accuracy=3", "compile=fast",
    "scenario.kappa_init=-1", "scenario.kappa_init=0", "scenario.intervals=3", "scenario.intervals=20001",
)  # fmt: skip


@pytest.mark.parametrize("wrong", WRONG)
def test_the_words_are_those_of_the_run(wrong: str) -> None:
    given = ("+scenario=circle", "solver=ipopt", wrong)
    with pytest.raises(BadInput) as early:
        check_at_once(given, PLACE)
    with pytest.raises(BadInput) as late:
        config.compose_any(*given)
    assert str(early.value) == str(late.value)


@pytest.mark.parametrize(
    "fine",
    [
        "seed=7", "time_limit=0.5", "accuracy=low", "scenario.kappa_init=13", "scenario.intervals=4",
        "seed=range(0,3)", "seed=1,2", "time_limit=1e3", "seed='-1'", "seed=null",
    ],
)  # fmt: skip
def test_what_is_right_or_not_plain_is_left_to_the_run(fine: str) -> None:
    check_at_once(("+scenario=circle", fine), PLACE)


def test_the_last_of_several_may_be_right() -> None:
    check_at_once(("+scenario=circle", "seed=-1", "seed=1"), PLACE)


@pytest.mark.parametrize("scenario", ["race", "steering", "nowhere", "transfer"])
def test_other_kinds_look_at_their_own_fields(scenario: str) -> None:
    check_at_once((f"+scenario={scenario}", "scenario.kappa_init=-1"), PLACE)
