"""How flights are asked for, and every mistake in doing so, as one message before anything is planned."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import pytest

from benchbench.flight.foretold import foretold
from benchbench.flight.predictor import Predictor, Seen
from benchbench.flight.residual import Learned, Residual, Sample
from benchbench.ground.errors import BadInput, BenchBenchError
from benchbench.ocp.motion import Motion
from benchbench.planning.case import Case
from benchbench.run import config
from benchbench.run.execution import config_hash
from benchbench.run.flying import DEFAULTS, campaign, flying
from benchbench_plugins.motions import Fixed, Linear
from benchbench_plugins.predictors.constant_turn import ConstantTurn
from benchbench_plugins.predictors.constant_velocity import ConstantVelocity
from benchbench_plugins.predictors.known import Known as Told
from benchbench_plugins.residuals.constant import Constant


def asked(*overrides: str) -> object:
    cfg, chosen = config.composed("+scenario=circle", *overrides)
    found = campaign(cfg, chosen)
    if found:
        case = config.build(cfg, chosen)
        found.check(getattr(case, "scenario", None), getattr(case, "model", None))
    return found


def test_who_chooses_how_to_fly_means_one_flight_and_the_other_choices() -> None:
    assert flying(["+scenario=circle", "solver=ipopt"]) == []
    assert flying(["flights=0"]) == []
    cfg, chosen = config.composed("+scenario=circle", "mismatch=windy", "rig.ball_mass=0.1")
    assert (cfg.flights, cfg.rig.ball_mass) == (1, 0.1)
    names = {**DEFAULTS, "mismatch": "windy"}
    found = campaign(cfg, chosen)
    assert found is not None and found.names == names and found.count == 1


def test_a_run_that_only_plans_keeps_its_hash() -> None:
    """Best known values and the resumption of sweeps hang on it."""
    hashes = [
        config_hash(config.composed("+scenario=circle", *more)[0])
        for more in ((), ("flights=0",), ("flights=0", "world=mujoco", "mismatch=lab2x"))
    ]
    assert len(set(hashes)) == 1
    flown = config_hash(config.composed("+scenario=circle", "flights=2")[0])
    assert flown != hashes[0]
    assert flown != config_hash(config.composed("+scenario=circle", "flights=2", "mismatch=none")[0])


@pytest.mark.parametrize(
    ("overrides", "field"),
    [
        (("flights=-1",), "flights"),
        (("flights=1.5",), "flights"),
        (("flights=1", "rig.motor_force=[2.5,8]"), "rig.motor_force"),
        (("flights=1", "rig.servo_torque=[-1,1]"), "rig.servo_torque"),
        (("flights=1", "rig.motor_force=[0,.inf]"), "rig.motor_force.1"),
        (("flights=1", "rig.motor_force=8"), "rig.motor_force"),
        (("flights=1", "rig.pull=0.5"), "rig"),
        (("flights=1", "scenario.magnet_reach=0.01"), "scenario.magnet_reach"),
        (("mismatch.mass=[0.1,-0.1]",), "mismatch.mass"),
        (("mismatch.drag=[0,.nan]",), "mismatch.drag.1"),
        (("mismatch.wnd=[0,0]",), "mismatch.wnd"),
        (("judge.touch_speed=0",), "judge.touch_speed"),
        (("judge.controller_late=2",), "judge.controller_late"),
        (("residual=unheard_of",), "residual"),
        (("mismatch.mass=[-1.2,0]",), "mismatch.mass.0"),
        (("mismatch.thrust=[-1.2,0]",), "mismatch.thrust.0"),
        (("certificate@judge=race", "flights=1"), "judge._target_"),
        (("residual=none", "residual.training=3"), "residual.training"),
        (("residual=gp", "residual.training=0"), "residual.training"),
        (("residual=constant", "residual.training=0"), "residual.training"),
        (("residual=gp", "residual.training=1e9"), "residual.training"),
        (("residual=gp", "residual.points=5000"), "residual.points"),
        (("residual=gp_observer", "residual.points=0"), "residual.points"),
        (("residual=observer", "residual.gain=.nan"), "residual.gain"),
        (("controller.stages=0",), "controller.stages"),
        (("controller.step=0.013",), "controller.step"),
        (("controller.step=100",), "controller.step"),
        (("controller.latency=10",), "controller.latency"),
        (("controller.rate_limit=[1]",), "controller.rate_limit.1"),
        (("controller=nmpc_ipopt", "controller.position=-1"), "controller.position"),
        (("autopilot.proportional=[1,1,-1]",), "autopilot.proportional.2"),
        (("world.servo_stiffness=.nan",), "world.servo_stiffness"),
        (("world=ode", "world.servo_damping=-1"), "world.servo_damping"),
        (("payload=estimated", "payload.gain=2"), "payload.gain"),
        (("predictor=constant_velocity", "predictor.window=-1"), "predictor.window"),
        (("predictor=gp", "predictor.points=0"), "predictor.points"),
    ],
)
def test_mistakes_name_their_field(overrides: tuple[str, ...], field: str) -> None:
    with pytest.raises(BadInput) as told:
        asked(*overrides)
    assert told.value.field == field


@pytest.mark.parametrize(
    ("overrides", "field"),
    [
        (("+scenario=race", "vehicle=race_quadrotor"), "flights"),
        (("+scenario=two_free",), "flights"),
        (("+scenario=pympcc", "~vehicle", "~dynamics", "~guess", "certificate=mpcc"), "flights"),
    ],
)
def test_what_cannot_be_flown_is_told(overrides: tuple[str, ...], field: str) -> None:
    cfg, chosen = config.composed(*overrides, "flights=1")
    found, case = campaign(cfg, chosen), config.build(cfg, chosen)
    assert found is not None
    with pytest.raises(BenchBenchError) as told:
        found.check(getattr(case, "scenario", None), getattr(case, "model", None))
    assert told.value.field == field  # type: ignore[attr-defined]


class Untrained(Residual):
    """Learns from flights, and asks for none."""

    def learn(self, flights: Sequence[Sequence[Sample]]) -> Learned:
        return Constant().learn(flights)


def test_what_learns_from_no_flight_is_told_before_anything_is_planned() -> None:
    cfg, chosen = config.composed("+scenario=circle", "flights=1")
    found, case = campaign(cfg, chosen), config.build(cfg, chosen)
    assert found is not None and isinstance(case, Case)
    with pytest.raises(BadInput, match="no training flight to learn from") as told:
        replace(found, residual=Untrained()).check(case.scenario, case.model)
    assert told.value.field == "residual"


class Off(Predictor):
    """Predicts a target that stands beside where it was seen."""

    def predict(self, seen: Seen) -> Motion:
        return Fixed(tuple(seen.position[-1] + 0.1))


def test_a_predictor_has_to_give_the_targets_kind_of_motion() -> None:
    """A level turn follows no target that climbs, whatever the speed; each is told before anything is planned."""
    level, climbing = Linear((0.9, 0.0, 0.4), (0.1, 0.0, 0.0)), Linear((0.9, 0.0, 0.4), (0.1, 0.0, 0.1))
    assert foretold(Told(), "known", climbing) is None
    assert foretold(ConstantTurn(), "constant_turn", level) is not None
    assert foretold(ConstantVelocity(), "constant_velocity", climbing) is not None
    for predictor, target in ((ConstantTurn(), climbing), (Off(), level)):
        with pytest.raises(BadInput, match="cannot give this target's kind of motion") as told:
            foretold(predictor, "it", target)
        assert told.value.field == "predictor"
    fast = ("scenario.target.rate_radps=-3", "predictor=constant_velocity")
    with pytest.raises(BadInput, match="'constant_velocity' cannot give"):
        asked(*fast)
