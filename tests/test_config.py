"""Configuration: every mistake is refused before anything is computed, by a message that names the field."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import pytest
from bad_inputs import SCENARIOS
from packages import install

from benchbench.ground.errors import BadInput, IncompatibleCase
from benchbench.planning.margins import least_margins
from benchbench.planning.validate import validate
from benchbench.run import config, pipeline
from benchbench.run.overrides import carried

EXAMPLE = Path(__file__).resolve().parents[1] / "examples" / "own_config"

# overrides, field that the message names, what it must say besides
REFUSED = [
    ("", "scenario", "+scenario=NAME with NAME one of " + SCENARIOS),
    ("solver=ipopt", "scenario", "none was chosen"),
    ("scenario.kappa_init=3", "scenario", "none was chosen"),
    ("+scenario=triangle", "scenario", "'triangle' does not exist; allowed: " + SCENARIOS),
    ("scenario=circle", "scenario", "+scenario=circle"),
    ("+scenario=handover", "scenario", "not a scenario; allowed: " + SCENARIOS),
    ("+scenario=static +scenario=circle", "scenario", "chosen twice"),
    ("+scenario=static guess=previous", "guess.path", "is not given and has no default; allowed: guess.path=VALUE"),
    ("+scenario=static solver=simplex", "solver", "'simplex' does not exist; allowed: "),
    ("+scenario=static +solver=ipopt", "solver", "solver=NAME without the plus sign"),
    ("+scenario=static ~solver", "solver", "solver=NAME with NAME one of "),
    ("+scenario=static vehicle=null", "a choice", "CHOICE=NAME"),
    ("+scenario=static +scenario/contact=flor", "scenario/contact", "allowed: approach, floor"),
    ("+scenario=static scenario.costs={a:3}", "scenario.costs", "needs a plus sign; allowed: +scenario.costs=VALUE, or +scenario.costs.NAME=VALUE"),
    ("+scenario=static scenario.obstacles.a=3", "scenario.obstacles",
     "needs a plus sign; allowed: +scenario.obstacles=VALUE, or +scenario.obstacles.NAME=VALUE"),
    ("+scenario=race scenario.kept_margins=[]", "scenario.kept_margins", "needs a plus sign; allowed: +scenario.kept_margins=VALUE"),
    ("+scenario=static +scenario.costs.a=3", "scenario.costs.a", "3 was given; allowed: {_target_: package.module.Class, ...} that makes a Cost"),
    ("+scenario=static scenario.gates=3", "scenario.gates", "does not exist; allowed: name, start, "),
    ("+scenario=static +scenario/cost=height", "scenario/cost", "there is no choice 'height'; allowed: what an installed package brings"),
    ("+scenario=static +scenario/obstacle=spere", "scenario/obstacle", "'spere' does not exist; allowed: approach, floor"),
    ("+scenario=static scenario.kapa_init=3", "scenario.kapa_init", "perhaps 'kappa_init' is meant"),
    ("+scenario=static +scenario.kapa_init=3", "scenario.kapa_init", "perhaps 'kappa_init' is meant"),
    ("+scenario=static +scenario.kappa_init=3", "scenario.kappa_init", "without the plus sign"),
    ("+scenario=static scenario.start.y=0.1", "scenario.start.y", "+scenario.start.y=VALUE"),
    ("+scenario=static vehicle.mass=1", "vehicle.mass", "quadrotor_mass"),
    ("+scenario=static +vehicle.mass=1", "vehicle.mass", "quadrotor_mass"),
    ("+scenario=static +dynamics.input=nodal", "dynamics.input", "perhaps 'inputs' is meant"),
    ("+scenario=static vehicle._target_=benchbench_plugins.solvers.ipopt.Ipopt", "vehicle._target_", "a Model"),
    ("+scenario=static +solver.foo=1", "solver.foo", "linear_solver, options"),
    ("+scenario=static +scenario.target.speed=1", "scenario.target.speed", "position_m"),
    ("+scenario=static sead=1", "sead", "perhaps 'seed' is meant"),
    ("+scenario=static +sead=1", "sead", "perhaps 'seed' is meant"),
    ("+scenario=static scenario.contacts.positon.limit=1", "scenario.contacts.positon", "perhaps 'position'"),
    ("+scenario=static scenario.intervals=abc", "scenario.intervals", "'abc' was given; allowed: a valid integer"),
    ("+scenario=static scenario.intervals=20.5", "scenario.intervals", "a valid integer"),
    ("+scenario=static scenario.intervals=10,20", "scenario.intervals", "-m in front"),
    ("+scenario=static,linear", "scenario", "-m in front"),
    ("+scenario=static dynamics.inputs=foo", "dynamics.inputs", "'interval', 'nodal' or 'averaged'"),
    ("+scenario=static vehicle.force_model=foo", "vehicle.force_model", "virtual_work, paper"),
    ("+scenario=static vehicle.arm_mass=-1", "vehicle.arm_mass", "-1 was given; allowed: a number greater than 0"),
    ("+scenario=static vehicle.arm_mass=nan", "vehicle.arm_mass", "finite"),
    ("+scenario=static vehicle.arm_mass=.nan", "vehicle.arm_mass", "a valid number"),
    ("+scenario=static vehicle.motor_force=[6,2]", "vehicle.motor_force", "must not exceed"),
    ("+scenario=static scenario.travel_time_guess=nan", "scenario.travel_time_guess", "a finite number"),
    ("+scenario=static scenario.travel_time_guess=.nan", "scenario.travel_time_guess", "a valid number"),
    ("+scenario=static scenario.travel_time=[5,1]", "scenario.travel_time", "must not exceed"),
    ("+scenario=static scenario.workspace.z=[2,1]", "scenario.workspace.z", "must not exceed"),
    ("+scenario=static scenario.target.position_m=[1,0]", "scenario.target.position_m.2", "is missing"),
    ("+scenario=static scenario.target.position_m=3", "scenario.target.position_m", "3 was given; allowed: a list"),
    ("+scenario=static scenario.target.position_m=[1,0,0,0]", "scenario.target.position_m", "too long; allowed: at most 3 values"),
    ("+scenario=static scenario.target.position_m=[nan,0,0]", "scenario.target.position_m.0", "a finite number"),
    ("+scenario=static scenario.target._target_=foo.Bar", "scenario.target._target_", "'foo.Bar' cannot be loaded"),
    ("+scenario=static scenario.contacts.position.limit=-1", "scenario.contacts.position.limit", "greater than 0"),
    ("+scenario=static scenario.kappa_init=0", "scenario.kappa_init", "greater than or equal to 1"),
    ("+scenario=static relaxation.schedule=[nan]", "relaxation.schedule", "finite"),
    ("+scenario=static certificate.residual=-1", "certificate.residual", "greater than 0"),
    ("+scenario=static time_limit=-1", "time_limit", "a number of seconds"),
    ("+scenario=static time_limit=inf", "time_limit", "a number of seconds"),
    ("+scenario=static iteration_limit=2.5", "iteration_limit", "a whole number of at least 1"),
    ("+scenario=static seed=-1", "seed", "a whole number of at least 0"),
    ("+scenario=static accuracy=extreme", "accuracy", "low, medium, high"),
    ("+scenario=static compile=always", "compile", "auto, never"),
    ("+scenario=static output=null", "output", "the path of a folder"),
    ("+scenario=static output=${nowhere}", "output", "nowhere"),
    ("+scenario=static scenario.target.position_m=[1,0", "'scenario.target.position_m=[1,0'", "FIELD=VALUE"),
]  # fmt: skip

# these need the case as a whole
IMPOSSIBLE = [
    ("scenario.kappa_init=200", "scenario.kappa_init", "200 nodes in contact do not fit into 100 intervals; allowed: 1 to 98"),
    ("scenario.travel_time=[-1,5]", "scenario.travel_time", "finite"),
    ("scenario.travel_time=[nan,5]", "scenario.travel_time", ""),
    ("scenario.travel_time=[0.1,inf]", "scenario.travel_time", "finite"),
    ("scenario.travel_time=[0.1,1]", "scenario.travel_time", "at least 2.303 s"),
    ("scenario.contact_seconds=0", "scenario.contact_seconds", "above 0"),
    ("scenario.contact_seconds=50", "scenario.contact_seconds", "below 30.0 s"),
    ("scenario.target.position_m=[1,0,6]", "scenario.target", "out of reach: its z"),
    ("scenario.target.position_m=[50,0,0.4]", "scenario.target", "out of reach"),
    ("scenario.start.z=5", "scenario.start.z", "5 m is outside its limits; allowed: 0 to 1.5 m"),
    ("+scenario.end.roll=1", "scenario.end.roll", "1 rad is outside its limits"),
    ("+scenario.start.elbow=1", "scenario.start.elbow", "allowed: x, y, z, roll, pitch, yaw, arm"),
    ("+scenario.rate_margin.elbow=0.1", "scenario.rate_margin.elbow", "x, y, z, roll, pitch, yaw, arm"),
    ("+scenario.workspace.elbow=[0,1]", "scenario.workspace.elbow", "x, y, z, roll, pitch, yaw, arm"),
    ("+scenario.contact_margin.positon=0.1", "scenario.contact_margin.positon", "position, velocity, heading"),
    ("scenario.workspace.z=[2,3]", "scenario.start.z", "2 to 3 m"),
    ("vehicle.motor_force=[0.1,0.2]", "vehicle", "cannot hover: motor_1 would have to be 4.95 N"),
    ("+solver.options.nonsense=1", "solver", "No such IPOPT option: nonsense"),
    ("+solver.options.mu_strategy=foo", "solver", "mu_strategy"),
    ("solver.linear_solver=foo", "solver", "linear_solver"),
]  # fmt: skip


@pytest.mark.parametrize(("overrides", "field", "says"), REFUSED, ids=[case[0] for case in REFUSED])
def test_mistake_is_refused_by_name(overrides: str, field: str, says: str) -> None:
    with pytest.raises(BadInput) as caught:
        validate(config.compose(*overrides.split()))
    assert str(caught.value).startswith(f"{field}: ") or str(caught.value).startswith(f"{field}.")
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)
    assert "hydra" not in str(caught.value).lower()


@pytest.mark.parametrize(("override", "field", "says"), IMPOSSIBLE, ids=[case[0] for case in IMPOSSIBLE])
def test_impossible_case_is_refused_by_name(override: str, field: str, says: str) -> None:
    with pytest.raises(BadInput) as caught:
        pipeline.run(config.compose("+scenario=static", override))
    assert caught.value.field == field
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_vehicle_that_cannot_do_it_is_told() -> None:
    """A pendulum may make a handover, but not one that speaks of x, y and z; it cannot race."""
    with pytest.raises(
        BadInput, match=r"scenario\.workspace\.z: the vehicle has no such coordinate; allowed: angle"
    ):
        validate(config.compose("+scenario=static", "vehicle=pendulum"))
    with pytest.raises(IncompatibleCase, match="vehicle: 'pendulum' cannot race"):
        validate(config.compose("+scenario=race", "vehicle=pendulum"))


@pytest.mark.parametrize("scenario", config.choices("scenario"))
def test_every_scenario_is_possible(scenario: str) -> None:
    asked = {"mpcc_file": ["scenario.path=some.json"]}  # has no default, and says so
    validate(config.compose_any(f"+scenario={scenario}", *asked.get(scenario, [])))


def test_a_file_that_must_be_named_is_asked_for() -> None:
    with pytest.raises(BadInput, match=r"scenario\.path"):
        config.compose_any("+scenario=mpcc_file")


def test_same_case_twice_in_one_process_gives_the_same_plan() -> None:
    overrides = ("+scenario=static", "scenario.intervals=20", "strategy=phases")
    first, second = (pipeline.run(config.compose(*overrides)) for _ in range(2))
    assert first.record["objective"] == second.record["objective"]
    assert first.record["mpcc_hash"] == second.record["mpcc_hash"]
    assert first.record["travel_time_s"] == pytest.approx(2.8, abs=0.02)


@pytest.mark.parametrize(
    ("overrides", "strategy"),
    [
        ("+scenario=static", "auto"),
        ("+scenario=static relaxation=kadrani", "relax"),
        ("+scenario=static relaxation.schedule=[1e-6]", "relax"),
        ("+scenario=static relaxation=kadrani strategy.margin=0", "relax"),
        ("+scenario=race relaxation=scholtes", "relax"),
        ("+scenario=two_free strategy=sequences relaxation=kadrani", "sequences"),
        ("+scenario=pympcc scenario.problem=kth1 relaxation=kadrani", "continuation"),
    ],
)
def test_who_asks_for_a_relaxation_gets_a_strategy_that_relaxes(overrides: str, strategy: str) -> None:
    assert config.compose_any(*overrides.split()).names["strategy"] == strategy


@pytest.mark.parametrize(
    ("overrides", "kept"),
    [
        ("strategy=phases", {}),
        ("scenario.rate_margin.arm=0.07", {"rate_margin": {"arm": 0.07}}),
        ("+scenario.contact_margin.velocity=0.1 strategy.margin=0.3", {"contact_margin": {"velocity": 0.1}}),
        ("strategy=enumeration scenario.contact_margin={position:0.02}", {"contact_margin": {"position": 0.02}}),
        ("strategy=multistart strategy@strategy.of=polish scenario.rate_margin.arm=0.07", {"rate_margin": {"arm": 0.07}}),
        ("scenario.rate_margin.arm=0.07 ~scenario.contact_margin.position", {"rate_margin": {"arm": 0.07}}),
        ("scenario.rate_margin.arm=0.07 +scenario.kept_margins=[]", {}),
    ],
)  # fmt: skip
def test_margins_by_hand_are_the_least_where_others_are_measured(
    overrides: str, kept: dict[str, dict[str, float]]
) -> None:
    case = config.compose("+scenario=static", *overrides.split())
    assert least_margins(case.scenario, 0.5) == {"rate_margin": {}, "contact_margin": {}, **kept}


def test_where_none_are_measured_those_of_the_scenario_hold() -> None:
    case = config.compose("+scenario=static", "scenario.rate_margin.arm=0.07", "strategy.margin=0")
    assert not case.scenario.kept_margins, "nobody needs to be told"
    held = {"rate_margin": {"arm": 0.07}, "contact_margin": {"position": 0.01}}
    assert least_margins(case.scenario, 0.0) == held


def test_a_kept_margin_is_one_of_the_scenario() -> None:
    with pytest.raises(
        BadInput, match=r"kept_margins: there is no margin 'rate_margin.x'; allowed: rate_margin.arm"
    ):
        config.compose("+scenario=static", "+scenario.kept_margins=[rate_margin.x]")


def test_margins_by_hand_leave_the_task_and_its_relaxations_as_they_are() -> None:
    margin = "scenario.rate_margin.arm=0.07"
    assert (
        config.compose("+scenario=static", margin).task_hash == config.compose("+scenario=static").task_hash
    )
    assert config.compose("+scenario=static", "relaxation=kadrani", margin).names["strategy"] == "relax"


def test_contact_that_is_switched_off_is_no_mistake() -> None:
    case = config.compose("+scenario=static", "scenario.contacts.position=null")
    validate(case)
    assert set(case.scenario.contacts) == {"velocity", "heading"}


def test_a_refused_case_does_not_disturb_the_next() -> None:
    with pytest.raises(BadInput):
        config.compose("+scenario=triangle")
    assert config.compose("+scenario=circle").scenario.name == "circle"


def test_own_folder_is_found_from_python() -> None:
    case = config.compose(f"hydra.searchpath=[file://{EXAMPLE}]", "+scenario=conveyor", "vehicle=long_arm")
    assert case.names["scenario"], case.names["vehicle"] == ("conveyor", "long_arm")
    assert case.scenario.start == {"y": 0.2, "z": 0.65, "arm": pytest.approx(1.5708, abs=1e-4)}
    validate(case)


def test_broken_yaml_is_named_with_its_line(tmp_path: Path) -> None:
    broken = tmp_path / "scenario" / "mine.yaml"
    broken.parent.mkdir()
    broken.write_text("name: mine\nstart: {z: 1\nend: 3\n")
    with pytest.raises(BadInput, match=r"mine\.yaml.*, line \d+: is no YAML"):
        config.compose(f"hydra.searchpath=[file://{tmp_path}]", "+scenario=mine")


def test_scenario_that_builds_on_a_missing_one_names_both(tmp_path: Path) -> None:
    mine = tmp_path / "scenario" / "mine.yaml"
    mine.parent.mkdir()
    mine.write_text("defaults:\n  - handovr\n  - _self_\nname: mine\n")
    with pytest.raises(BadInput, match=r"^scenario/mine: builds on 'scenario/handovr', which"):
        config.compose(f"hydra.searchpath=[file://{tmp_path}]", "+scenario=mine")


def test_scenario_without_target_says_so(tmp_path: Path) -> None:
    mine = tmp_path / "scenario" / "mine.yaml"
    mine.parent.mkdir()
    mine.write_text("defaults:\n  - handover\n  - _self_\nname: mine\n")
    with pytest.raises(BadInput, match=r"^scenario\.target: is missing$"):
        config.compose(f"hydra.searchpath=[file://{tmp_path}]", "+scenario=mine")


def test_missing_csv_of_a_target_is_named(tmp_path: Path) -> None:
    mine = tmp_path / "scenario" / "mine.yaml"
    mine.parent.mkdir()
    target = "target:\n  _target_: benchbench_plugins.motions.Spline\n  csv: no.csv\n"
    mine.write_text(f"defaults:\n  - handover\n  - _self_\nname: mine\n{target}")
    with pytest.raises(BadInput, match=r"^scenario\.target\.csv: cannot read 'no\.csv'.*t,x,y,z"):
        validate(config.compose(f"hydra.searchpath=[file://{tmp_path}]", "+scenario=mine"))


def test_wrong_configuration_folder_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("BENCHBENCH_CONF", str(tmp_path))
    with pytest.raises(BadInput, match="BENCHBENCH_CONF"):
        config.folder()


def test_configuration_of_an_installed_package_is_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A distribution with the entry point `benchbench.conf`, laid out as pip does."""
    package = tmp_path / "theirs_conf"
    shutil.copytree(EXAMPLE, package)
    (package / "__init__.py").touch()
    monkeypatch.syspath_prepend(install(tmp_path, "theirs", {"benchbench.conf": {"theirs": "theirs_conf"}}))
    try:
        assert "conveyor" in config.choices("scenario")
        assert config.compose("+scenario=conveyor").scenario.name == "conveyor"
    finally:
        sys.modules.pop("theirs_conf", None)


def test_fixed_fields_of_swept_choices_wait_for_the_choice() -> None:
    given = [
        "+scenario=a,b",
        "scenario.travel_time=[1,2]",
        "+scenario.start.y=1",
        "seed=3",
        "scenario.kappa_init=2,5",
    ]
    wanted = [
        "+scenario=a,b", "scenario.travel_time=choice([1,2])", "+scenario.start.y=choice(1)", "seed=3",
        "scenario.kappa_init=2,5",
    ]  # fmt: skip
    assert carried(given) == wanted
    assert carried(["+scenario=a", "scenario.intervals=20"]) == ["+scenario=a", "scenario.intervals=20"]
