"""Tasks that no flight can do: refused before anything is solved, with the two demands that contradict each other."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from benchbench.certificate.bound import lower_bound
from benchbench.certificate.conflict import conflict
from benchbench.certificate.course import Course
from benchbench.ground.errors import BadInput
from benchbench.planning.validate import validate
from benchbench.run import config

PROVED: dict[str, tuple[str, str, tuple[str, ...]]] = {
    # name: (overrides, field, words of both demands)
    "the nose cannot follow": (
        "+scenario=hardware_circle_23 scenario.target.rate_radps=-0.3", "scenario.target",
        ("turns at 0.3 rad/s", "yaw rate is limited to 0.1 rad/s while heading is asked within 0.01 rad"),
    ),
    "nor with a faster vehicle": (
        "+scenario=circle scenario.target.rate_radps=-3 scenario.target.radius_m=0.3 scenario.contact_seconds=1", "scenario.target",
        ("turns at 3 rad/s", "yaw rate is limited to 2 rad/s while heading is asked within 0.1 rad"),
    ),
    "faster than the vehicle for a while": (
        "+scenario=linear scenario.target.velocity_mps=[1.6,0,0] scenario.contact_seconds=3", "scenario.target",
        ("the target moves at 1.6 m/s or more along x while contact lasts 3 s", "the vehicle flies 1.3 m/s along x at most"),
    ),
    "never caught": (
        "+scenario=linear scenario.target.velocity_mps=[1.6,0,0] scenario.target.start_m=[1,0,0.4]", "scenario.target",
        ("too far along x", "flies 1.3 m/s along x"),
    ),
    "caught too late": (
        "+scenario=linear scenario.target.velocity_mps=[1.25,0,0] scenario.target.start_m=[9,0,0.4] scenario.travel_time=[0.1,10]",
        "scenario.target", ("within 10 s", "too far along x", "flies 1.3 m/s along x"),
    ),
    "above the room": ("+scenario=static scenario.target.position_m=[1,0,2.2]", "scenario.target", ("its z goes from 2.2", "1.752 m")),
    "below the ground": ("+scenario=static scenario.target.position_m=[1,0,-0.6]", "scenario.target", ("its z goes from -0.6", "-0.252")),
    "too far away": ("+scenario=static scenario.target.position_m=[50,0,0.4]", "scenario.target", ("too far along x", "1.3 m/s")),
    "no time": ("+scenario=circle scenario.travel_time=[0.1,2]", "scenario.travel_time", ("2 s are too short", "2.303 s")),
    "end outside the room": ("+scenario=static scenario.end.z=1.8", "scenario.end.z", ("1.8 m is outside", "0 to 1.5 m")),
    "contact as long as the flight": (
        "+scenario=static scenario.contact_seconds=29", "scenario.target", ("come near the target and be at the end within 30 s", "1.3 m/s"),
    ),
    "too weak to hover": ("+scenario=static vehicle.motor_force=[1,4]", "vehicle", ("cannot hover", "4.95 N", "1 to 4 N")),
    "too strong to hover": ("+scenario=static vehicle.motor_force=[5.2,8]", "vehicle", ("cannot hover", "4.95 N", "5.2 to 8 N")),
    "a race in no time": ("+scenario=race scenario.gates=3 scenario.travel_time=[0.1,1]", "scenario.travel_time", ("too short for this race",)),
}  # fmt: skip


def made(words: str) -> Any:
    return config.compose(*words.split(), "solver=ipopt")


@pytest.mark.parametrize("name", PROVED)
def test_an_impossible_task_is_refused_with_both_demands(name: str) -> None:
    words, field, said = PROVED[name]
    with pytest.raises(BadInput) as refused:
        validate(made(words))
    assert refused.value.field == field
    for part in said:
        assert part in str(refused.value)


POSSIBLE = (
    # each is the last but one step before a refusal above, and has been certified or is flown in other tests
    "+scenario=hardware_circle", "+scenario=circle scenario.travel_time=[0.1,2.9]", "+scenario=static scenario.contact_seconds=1",
    "+scenario=linear scenario.target.velocity_mps=[0,0,1.3] scenario.target.start_m=[1,0,-2]",
    "+scenario=random_handover seed=54", "+scenario=random_hardware seed=11",
)  # fmt: skip


@pytest.mark.parametrize("words", POSSIBLE)
def test_a_task_that_was_flown_is_not_refused(words: str) -> None:
    case = made(words)
    validate(case)
    plant, (stop,) = case.model.plant(), case.scenario.itinerary.stops
    assert conflict(case.scenario, stop, case.model, plant) is None
    assert np.isfinite(lower_bound(case.scenario, case.model, plant))


# --- the direction of a target, cell by cell ------------------------------------------------------------------------


def test_a_turn_is_followed_up_to_what_is_granted() -> None:
    """0.3 rad/s in cells of 10 ms: over 1 s the nose may turn 0.1 rad and be off 0.05 rad on either side, over 0.5 s enough."""
    angle = 0.3 * 0.01 * np.arange(400) + 3.0
    moving = 0.1 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    course = Course.of(moving, 0.05)
    begin = np.arange(0, 250, 10)
    assert not course.followed(begin, begin + 100, 0.1).any(), "also across pi"
    assert course.followed(begin, begin + 50, 0.1).all()
    assert (
        not course.followed(begin, begin + 70, 0.05).any() and course.followed(begin, begin + 70, 0.15).all()
    )


def test_a_target_that_stands_somewhere_or_turns_back_may_be_met_there() -> None:
    """A target that goes back the way it came asks for half a turn, but it stands in between, where any heading is right."""
    speed = np.linspace(0.2, -0.2, 401)
    course = Course.of(np.stack([speed, 0 * speed, 0 * speed], axis=1), 0.05)
    far = np.array([150])
    assert course.followed(far, far + 100, 0.0).all()
    assert course.free[200] and not course.free[100]
    assert course.off(0.0)[100] == 0.0 and abs(course.off(0.0)[300]) == pytest.approx(np.pi - 0.05, abs=1e-9)
    assert not course.off(None).any()
