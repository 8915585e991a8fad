"""What is plainly wrong is told before Hydra is imported: in the words of the run itself, and only where it is plain."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import hydra
import pytest
from packages import install

from benchbench.ground.errors import BadInput
from benchbench.ocp import kinds, values
from benchbench.run import config, plainly
from benchbench.run.choices import folder

PLACE = Path(folder()) / "scenario"
WRONG = (
    "seed=-1", "seed=0.5", "time_limit=0", "time_limit=ten", "time_limit=nan", "iteration_limit=0", "accuracy=best", "accuracy=3",
    "compile=fast", "workers=0", "repeats=1.5", "hard_limit=inf", "memory_limit_mb=true", "rerun=some", "rerun=null", "picture=maybe",
    "scenario.kappa_init=-1", "scenario.contact_guess=1e1", "scenario.rate_margin.arm=2", "scenario.end.x=nan",
)  # fmt: skip
TRIED = (-1, 0, 1, 2.5, 1e9, "nan", "-inf", "no_such_word", "true", "null")


def early(*arguments: str) -> str:
    """What is told at once; nothing where that is left to the run."""
    try:
        plainly.check(arguments, PLACE)
    except BadInput as error:
        return str(error)
    return ""


@pytest.mark.parametrize("wrong", WRONG)
def test_the_words_are_those_of_the_run(wrong: str) -> None:
    given = ("+scenario=circle", "solver=ipopt", wrong)
    with pytest.raises(BadInput) as late:
        config.compose_any(*given)
    assert early(*given) == str(late.value)


@pytest.fixture(scope="module", params=["circle", "race", "transfer"])
def scenario(request: pytest.FixtureRequest) -> tuple[str, dict[str, Any]]:
    """A scenario and all that it consists of."""
    cfg, _ = config.composed(f"+scenario={request.param}")
    return request.param, hydra.utils.instantiate(cfg.scenario, _convert_="all")


def test_each_plain_field_is_told_as_by_the_whole_scenario(scenario: tuple[str, dict[str, Any]]) -> None:
    name, whole = scenario
    kind = values.own_kind(whole)
    assert kind
    refused = set()
    for field in [field for field in kind.model_fields if field in whole]:
        inside = next(iter(whole[field]), None) if isinstance(whole[field], dict) else None
        for value in TRIED:
            place = f"scenario.{field}" + (f".{inside}" if inside else "")
            said = early(f"+scenario={name}", f"{place}={value}")
            meant = plainly._values(str(value))[0]
            given = {**whole, field: {**whole[field], inside: meant} if inside else meant}
            assert said == late_of(given), (place, value)
            refused |= {field} if said else set()
    assert refused == {field for field in kind.model_fields if field in whole}


def late_of(given: dict[str, Any]) -> str:
    try:
        config.scenario_of(given)
    except BadInput as error:
        return str(error)
    return ""


@pytest.mark.parametrize(
    "fine",
    [
        "seed=7", "time_limit=0.5", "accuracy=low", "scenario.kappa_init=13", "scenario.intervals=4", "workers=null", "picture=true",
        "seed=range(0,3)", "seed=1,2", "time_limit=1e3", "seed='-1'", "scenario.order=free", "+scenario.kappa_init=0",
        "scenario.contacts.position.limit=-1", "scenario.kappa_init.more=0", "scenario.no_such_field=-1",
    ],
)  # fmt: skip
def test_what_is_right_or_not_plain_is_left_to_the_run(fine: str) -> None:
    assert not early("+scenario=circle", fine)


def test_the_last_of_several_may_be_right() -> None:
    assert not early("+scenario=circle", "seed=-1", "seed=1")
    assert not early("+scenario=circle", "scenario.kappa_init=0", "++scenario.kappa_init=3")


def test_what_a_family_draws_is_left_to_it() -> None:
    assert not early("+scenario=random_handover", "scenario.intervals=drawn")
    assert early("+scenario=random_handover", "scenario.intervals=3")
    assert early("+scenario=random_handover", "scenario.start.arm=nan"), "what it builds on has that"


@pytest.mark.parametrize("scenario_name", ["race", "steering", "nowhere", "transfer"])
def test_other_kinds_look_at_their_own_fields(scenario_name: str) -> None:
    assert not early(f"+scenario={scenario_name}", "scenario.kappa_init=-1")


def test_a_ready_made_problem_looks_at_its_own_fields(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text("_target_: mine.Mine\nname: mine\nintervals: 2\n")
    plainly.check(("+scenario=mine", "scenario.intervals=3"), tmp_path)


def test_where_another_kind_is_installed_a_scenario_may_be_its_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(
        install(tmp_path, "strange", {"benchbench.scenarios": {"strange": "strange:Strange"}})
    )
    assert not early("+scenario=circle", "scenario.kappa_init=0")
    assert early("+scenario=race", "scenario.gates=0")


def test_values_are_those_of_the_kinds() -> None:
    assert {
        name: own for name, own in values.OWN.items() if issubclass(kinds.OWN[name], own)
    }.keys() == kinds.OWN.keys()
