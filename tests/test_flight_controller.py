"""The real-time iteration against the same program solved to convergence, and its pieces against independent ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from benchbench.conformance.checks.flying import RIG, Obedient, known, vehicle, wandering
from benchbench.flight.controller import Controller
from benchbench.flight.reference import Reference, tip
from benchbench.flight.residual import Recorder, Residual, Sample
from benchbench.flight.sensed import Command, Sensed
from benchbench.flight.training import training_reference
from benchbench.ground.arrays import Array
from benchbench_plugins.controllers.centred import aside
from benchbench_plugins.controllers.nmpc import Nmpc
from benchbench_plugins.controllers.nmpc_ipopt import NmpcIpopt
from benchbench_plugins.controllers.prediction import Prediction
from benchbench_plugins.controllers.receding import Receding
from benchbench_plugins.controllers.tables import GRID, tables
from benchbench_plugins.payloads.estimated import Estimated
from benchbench_plugins.residuals.filtered import Filtered
from benchbench_plugins.residuals.gp import Gp
from benchbench_plugins.residuals.gp_observer import GpObserver

pytest.importorskip("daqp", reason="daqp is not installed")


def near(seconds: float) -> Reference:
    """A wandering with a ball at the end effector from 0 s on, the window of which ends after some seconds."""
    way, frame = wandering(), vehicle().airframe
    place, speed = tip(way.state, frame.arm_offset, frame.arm_length)
    return replace(way, target=np.hstack([place, speed]), window=(0.0, seconds))


def flown(controller: Controller, commands: int, reference: Reference | None = None) -> Array:
    """Positions (n, 3) of a body that obeys, from 6 cm beside."""
    reference = reference or wandering()
    body = Obedient(reference)
    step = controller.prepare(known(reference), Recorder(), lambda sensed, command, along: 0.0)
    body.state[:3] += [0.05, -0.03, 0.02]
    found = []
    for _ in range(commands):
        body.obey(step(body.sensed(), body.time))
        found.append(body.state[:3].copy())
    return np.array(found)


def test_one_newton_step_a_command_is_as_good_as_convergence() -> None:
    """Within 1 mm on a way back of 6 cm; a linearisation with a wrong sign is centimetres off."""
    one, other = (flown(controller, 40) for controller in (Nmpc(soft_speed=0.0), NmpcIpopt()))
    assert np.abs(one - other).max() < 1e-3


def test_so_it_is_where_the_end_effector_counts() -> None:
    """Both programs weigh its velocity alike; what it costs the way back is seen, or nothing was compared."""
    one, other = (flown(controller, 40, near(1.5)) for controller in (Nmpc(soft_speed=0.0), NmpcIpopt()))
    assert np.abs(one - other).max() < 1e-3
    assert np.abs(one - flown(Nmpc(soft_speed=0.0), 40)).max() > 5e-3


def test_levers_turn_body_rates_into_the_end_effectors_velocity() -> None:
    """Against differences of the end effector's own velocity; where no ball is near they are zero."""
    reference, frame = near(1.0), vehicle().airframe
    table, each = tables(reference, frame, 0.05), round(GRID / reference.step)
    for row in (0, 60, 110):
        state = reference.state[table.row(0.0) * each + row * each]
        turned = np.tile(state, (4, 1))
        turned[1:, 11:14] += np.eye(3)
        speed = tip(turned, frame.arm_offset, frame.arm_length)[1]
        wanted = (speed[1:] - speed[0]).T if row <= 100 else np.zeros((3, 3))
        np.testing.assert_allclose(table.lever[table.row(0.0) + row], wanted, atol=1e-12)
    assert not tables(wandering(), frame, 0.05).lever.any()


def descending(deepest: float) -> Reference:
    """A wandering whose ball comes nearer from below at 0.1 m/s until the clearance is `deepest` at 1 s, then stays; window until 1.5 s."""
    way, frame = wandering(), vehicle().airframe
    place, speed = tip(way.state, frame.arm_offset, frame.arm_length)
    clear = np.maximum(deepest + 0.1 * (1.0 - way.time), deepest)
    place[:, 2] -= clear
    speed[:, 2] += np.where(way.time < 1.0, 0.1, 0.0)
    return replace(way, target=np.hstack([place, speed]), window=(1.0, 1.5))


def test_a_plan_is_followed_aside_of_the_ball_by_half_of_the_room() -> None:
    """From the reach until the planned contact begins; the room is the depth but for 40 ms of the way in. Less before a short contact."""
    frame, ball = vehicle().airframe, descending(0.01)
    place, speed = aside(ball, frame, 0.5)
    between = (ball.time >= 1.0 - (ball.reach - 0.01) / 0.1 + ball.step) & (ball.time <= 1.0)
    np.testing.assert_allclose(place[between] - [0, 0, (ball.reach - 0.01 - 0.004) / 2], 0.0, atol=1e-9)
    assert not place[ball.time > 1.51].any() and not place[ball.time < 0.3].any()
    np.testing.assert_allclose(np.cumsum(speed, axis=0) * ball.step, place, atol=1e-4)
    short = replace(ball, window=(1.0, 1.12))  # a quarter of 0.24 s but for 40 ms: 20 ms at 0.1 m/s
    np.testing.assert_allclose(aside(short, frame, 0.5)[0][between, 2], 0.002, atol=2.5e-4)
    for nothing in (
        aside(descending(ball.reach - 0.003), frame, 0.5),
        aside(wandering(), frame, 0.5),
        aside(ball, frame, 0.0),
    ):
        assert not nothing[0].any() and not nothing[1].any()


def test_where_it_is_led_aside_the_vehicle_goes() -> None:
    """What is followed is the reference and what is added to it: the inputs stay those of the reference."""
    ball = descending(0.01)
    led, plain = (flown(Nmpc(aside=share), 150, ball) for share in (0.5, 0.0))
    when = ball.time[0] + 0.02 * np.arange(1, 151)
    place = np.stack(
        [np.interp(when, ball.time, c) for c in aside(ball, vehicle().airframe, 0.5)[0].T], axis=-1
    )
    late = when > 0.5
    assert np.abs((led - plain - place)[late]).max() < 1.5e-3 < np.abs(place).max() / 2


def test_the_model_is_the_papers() -> None:
    """One stage of RK4 against SciPy's integrator with rotation matrices, to the error of RK4 over 50 ms."""
    draw, g, h = np.random.default_rng(3), 9.8066, 0.05
    prediction = Prediction(g, h, 1)
    for _ in range(5):
        turn, omega, push = Rotation.random(rng=draw), draw.uniform(-2, 2, 3), draw.uniform(5, 15)
        p, v = draw.uniform(-1, 1, 3), draw.uniform(-1, 1, 3)

        def slope(t: float, y: Array) -> Array:
            up = (turn * Rotation.from_rotvec(omega * t)).as_matrix()[:, 2]  # noqa: B023
            return np.concatenate([y[3:], push * up - [0, 0, g]])  # noqa: B023

        exact = solve_ivp(slope, (0, h), np.concatenate([p, v]), rtol=1e-11, atol=1e-11).y[:, -1]
        q = turn.as_quat(scalar_first=True)
        inputs = np.concatenate([omega, [push]])[None]
        prediction.run(np.concatenate([p, q, v]), inputs, np.zeros((1, 10)))
        after = prediction.after[0]
        np.testing.assert_allclose(after[[0, 1, 2, 7, 8, 9]], exact, atol=2e-6)
        turned = (turn * Rotation.from_rotvec(omega * h)).as_quat(scalar_first=True)
        np.testing.assert_allclose(after[3:7] * np.sign(after[3:7] @ turned), turned, atol=1e-5)


def test_derivatives_are_those_of_the_prediction() -> None:
    draw, step = np.random.default_rng(4), 1e-6
    prediction = Prediction(9.8, 0.05, 3)
    first = np.concatenate([draw.normal(size=3), Rotation.random(rng=draw).as_quat(), draw.normal(size=3)])
    inputs, offsets = draw.uniform(-1, 1, (3, 4)) + np.array([0, 0, 0, 10]), 1e-3 * draw.normal(size=(3, 10))
    prediction.run(first, inputs, offsets)
    by_state, by_input = prediction.by_state[0].copy(), prediction.by_input[0].copy()
    for k in range(10):
        moved = step * np.eye(10)[k]
        prediction.run(first + moved, inputs, offsets)
        there = prediction.after[0].copy()
        prediction.run(first - moved, inputs, offsets)
        np.testing.assert_allclose((there - prediction.after[0]) / (2 * step), by_state[:, k], atol=1e-7)
    for k in range(4):
        moved = np.zeros((3, 4))
        moved[0, k] = step
        prediction.run(first, inputs + moved, offsets)
        there = prediction.after[0].copy()
        prediction.run(first, inputs - moved, offsets)
        np.testing.assert_allclose((there - prediction.after[0]) / (2 * step), by_input[:, k], atol=1e-7)


def test_the_reference_is_a_solution_of_the_controllers_own_model() -> None:
    """From each of its states, the tabulated inputs and offset lead to its state a stage later."""
    reference = wandering()
    table = tables(reference, vehicle().airframe, 0.05)
    prediction = Prediction(vehicle().airframe.gravity, 0.05, 1)
    for row in range(0, len(table.state) - 10, 40):
        prediction.run(table.state[row], table.inputs[row : row + 1], table.offset[row : row + 1])
        np.testing.assert_allclose(prediction.after[0], table.state[row + 5], atol=1e-12)
        assert (
            np.abs(table.offset[row]).max() < 0.02
        )  # what the model misses is small, or its inputs were wrong


def test_noise_is_filtered_and_the_truth_is_not() -> None:
    """Half of the noise of a sensed state is gone from the estimate; of a state without noise nothing is changed."""
    off, exact = _estimated(0.01), _estimated(0.0)
    assert np.sqrt(np.mean(off**2)) < 0.7 * 0.01
    assert np.abs(exact).max() < 1e-3


def _estimated(noise: float) -> Array:
    """Errors (n, 3) m of the estimated position, the body's velocity being sensed exactly."""
    body, draw, found = Obedient(wandering()), np.random.default_rng(5), []
    step = Nmpc().prepare(known(wandering()), Recorder(), lambda sensed, command, along: 0.0)
    assert isinstance(step, Receding)
    for _ in range(80):
        sensed, true = body.sensed(), body.state[:3].copy()
        sensed.state[:3] += draw.normal(0.0, noise, 3) if noise else 0.0
        body.obey(step(sensed, body.time))
        found.append(step.estimate.state[:3] - true)
    return np.array(found)


def test_what_hangs_at_the_magnet_is_weighed_and_the_observer_keeps_none_of_it() -> None:
    """In wind, after the magnet's pull on the vehicle: the whole mass is found, and the wind that was there before stays the wind."""
    body, wind, ball = Obedient(wandering()), np.array([0.2, 0.0, -0.3]), 0.2
    correction, mass = Filtered(0.1), vehicle().airframe.total_mass
    step = Nmpc().prepare(known(wandering()), correction, Estimated().prepare(RIG, mass))
    assert isinstance(step, Receding)
    for command in range(140):
        attached, pulled = command >= 60, 55 <= command < 60
        body.push, body.mass = wind - [0.0, 0.0, 3.0 * pulled], mass + ball * attached
        body.obey(step(replace(body.sensed(), attached=attached), body.time))
    assert step.estimate.payload == pytest.approx(ball, abs=0.02)
    np.testing.assert_allclose(correction.value, wind, atol=0.08)


def test_a_shock_throws_no_weighing_and_the_first_readings_count_alike() -> None:
    """Readings of 0.2 kg are believed at once; one of -3 kg, as a ball that hits the magnet gives, takes a sixth of them."""
    vehicle_mass, ball, thrust = 1.4, 0.2, 17.0
    weigh = Estimated().prepare(RIG, vehicle_mass)
    command, mass, found = Command(0.0, thrust, *[(0.0, 0.0, 0.0)] * 4), 0.0, []
    for reading in [ball, ball, ball, ball, ball, ball, ball, -3.0, ball, ball]:
        along = (mass - reading) * thrust / (vehicle_mass + mass) ** 2
        mass = weigh(Sensed(0.0, np.zeros(15), True), command, along)
        found.append(mass)
    np.testing.assert_allclose(found[:7], ball, atol=1e-9)
    assert found[7] == pytest.approx(ball * 0.85) and found[7] < found[8] < found[9] < ball
    full = replace(command, thrust=0.9 * 4 * RIG.motor_force[1])
    assert weigh(Sensed(0.0, np.zeros(15), True), full, -5.0) == mass, "a motor at its limit is no mass"
    assert weigh(Sensed(0.0, np.zeros(15), False), command, 0.0) == 0.0


@pytest.mark.parametrize("residual", [Gp, GpObserver])
def test_wind_that_was_learned_does_not_turn_with_the_nose(residual: type[Residual]) -> None:
    """Trained with the nose along x, in wind and drag; predicted with the nose along y, where the wind is the same."""
    pytest.importorskip("sklearn", reason="scikit-learn is not installed")
    wind, drag, time = np.array([-0.12, 0.1, -0.3]), 0.15, np.arange(700) / 50
    speed = np.stack([0.6 * np.sin(w * time + w) for w in (1.1, 1.7, 2.3)], axis=-1)
    samples = []
    for t, v in zip(time, speed, strict=True):
        state = np.zeros(15)
        state[2:4], state[7], state[8:11] = (1 + 0.1 * np.sin(t), 1.0), 1.5 + 0.3 * np.sin(2 * t), v
        samples.append(Sample(float(t), state, wind - drag * v))
    known = residual().learn([samples])()
    for yaw in (0.0, 1.57, 3.0):
        node = np.zeros((1, 10))
        node[0, 2:4], node[0, 6], node[0, 7:] = (1.0, np.cos(yaw / 2)), np.sin(yaw / 2), (0.3, -0.2, 0.1)
        found = known.predict(node, np.array([1.5]))[0][0]
        np.testing.assert_allclose(found, wind - drag * node[0, 7:], atol=0.02)


def test_a_training_flight_asks_for_what_motors_can_give() -> None:
    """Body rates change by no more than a manoeuvre's, also where the wandering begins; 50 rad/s^2 once stood there."""
    for seed in range(6):
        reference = training_reference(wandering(), vehicle().airframe, 12.0, seed)
        assert np.abs(np.gradient(reference.state[:, 11:14], reference.step, axis=0)).max() < 5.0
        low, high = vehicle().airframe.motor_force
        assert low < reference.inputs[:, :4].min() and reference.inputs[:, :4].max() < high
