"""The flight at once against the flight in turn, against scipy on its own, and on the method's own terms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from flights import TABLE_I
from scipy.integrate import DOP853, solve_ivp

from benchbench.certificate import dop853, dop853_coefficients, sequential
from benchbench.certificate.pieces import Pieces
from benchbench.certificate.replay import FAR, TOLERANCE, fly, replay
from benchbench.certificate.shooting import Shot, roughly, settled
from benchbench.ground.arrays import Array
from benchbench.ocp.model import Model
from benchbench.ocp.plan import Interpolation, Plan
from benchbench_plugins.models.aerial_manipulator import AerialManipulator
from benchbench_plugins.models.quadrotor import Quadrotor

RACER = {
    "mass": 0.85, "inertia": (0.001, 0.001, 0.0017), "lever": 0.15, "torque_coefficient": 0.05,
    "motor_force": (0.0, 6.8794), "body_rate": (15.0, 15.0, 0.3), "gravity": 9.801,
}  # fmt: skip
MODELS: dict[str, Model] = {
    "arm": AerialManipulator("arm", **TABLE_I),
    "arm in quaternions": AerialManipulator("arm", attitude="quaternion", **TABLE_I),
    "racer": Quadrotor("racer", **RACER),
    "racer in angles": Quadrotor("racer", **RACER, attitude="euler"),
}
FRACTIONS = np.arange(1, 11) / 10
N = 24
CONTROLS: dict[Interpolation, int] = {"hold": N, "linear": N + 1, "bezier": 3 * N}


def rest(model: Model) -> Array:
    """Half a metre up, at rest, the arm downwards."""
    names = model.configuration.names
    one = {"z": 0.5, "qw": 1.0, "arm": np.pi / 2}
    assert "qw" in names or "yaw" in names
    return np.array([one.get(name, 0.0) for name in (*names, *model.velocity.names)])[: len(names)]


def planned(
    model: Model, how: Interpolation = "hold", step: float = 0.03, strength: float = 0.02, off: float = 1e-3
) -> Plan:
    """Random inputs about hover; the states are flown in turn, but for what each node is `off`. Steps of two lengths."""
    random = np.random.default_rng(3)
    q, v = model.configuration, model.velocity
    time = np.cumsum([0.0, *np.repeat([step, 0.7 * step], N // 2)])
    wiggle = random.normal(size=(CONTROLS[how], len(model.inputs.names)))
    inputs = model.hover() + strength * wiggle * np.where(model.hover() > 0, model.hover(), 0.1)
    start = np.concatenate([rest(model), np.zeros(len(v.names))])
    still = np.tile(start, (N + 1, 1))
    plan = Plan.of(
        model, time=time, configuration=still[:, : len(q.names)], velocity=still[:, len(q.names) :],
        inputs=inputs, progress=np.zeros(N + 1), interpolation=how,
    )  # fmt: skip
    states = sequential.flight(plan, model.plant(), np.ones(1), (), TOLERANCE, FAR)[:, 0]
    states = np.vstack([start, states + off * random.normal(size=states.shape)])
    return replace(plan, configuration=states[:, : len(q.names)], velocity=states[:, len(q.names) :])


def flown_by_scipy(plan: Plan, model: Model, restarts: tuple[int, ...] = ()) -> Array:
    """States (N, 10, n) by LSODA at 1e-11, with inputs read from the plan at each moment, a little inside the interval."""
    plant, half = model.plant(), plan.configuration.shape[1]
    planned = np.hstack([plan.configuration, plan.velocity])
    state, found = planned[0], []
    for k in range(plan.intervals):
        begin, end = plan.time[k], plan.time[k + 1]

        def rate(t: float, y: Array, begin: float = begin, end: float = end) -> Array:
            inside = np.clip(t, begin + 1e-12, end - 1e-12)
            u = plan.input_at(np.array([inside]))[0]
            return np.concatenate(
                [plant.kinematics(y[:half], y[half:]), plant.acceleration(y[:half], y[half:], u)]
            )

        times = begin + (end - begin) * FRACTIONS
        times[-1] = end
        flight = solve_ivp(rate, (begin, end), state, "LSODA", times, rtol=1e-11, atol=1e-11)
        found.append(flight.y.T)
        state = planned[k + 1] if k + 1 in restarts else flight.y[:, -1]
    return np.array(found)


def at_once(plan: Plan, model: Model, restarts: tuple[int, ...] = ()) -> tuple[Shot, Shot]:
    """Each interval alone, and the whole flight, both without the flight in turn."""
    start = np.hstack([plan.configuration, plan.velocity])[:-1]
    alone = settled(Shot.of(Pieces.of(plan, model.plant()), start), np.arange(plan.intervals), TOLERANCE, FAR)
    assert alone is not None
    whole = settled(alone, np.array([0, *restarts]), TOLERANCE, FAR)
    assert whole is not None
    return alone, whole


@pytest.mark.parametrize("how", CONTROLS)
@pytest.mark.parametrize("name", MODELS)
def test_at_once_and_in_turn_agree(name: str, how: Interpolation) -> None:
    model, restarts = MODELS[name], (5, 6, 17)
    plan = planned(model, how)
    alone, whole = at_once(plan, model, restarts)
    in_turn = sequential.flight(plan, model.plant(), FRACTIONS, restarts, TOLERANCE, FAR)
    np.testing.assert_allclose(whole.at(FRACTIONS), in_turn, rtol=0, atol=1e-8)
    np.testing.assert_allclose(
        alone.ends, sequential.ends(plan, model.plant(), TOLERANCE, FAR), rtol=0, atol=1e-8
    )


@pytest.mark.parametrize("name", ["arm", "arm in quaternions"])
def test_at_once_and_by_another_method_agree(name: str) -> None:
    """LSODA shares no code with either, and reads the inputs by their time."""
    model = MODELS[name]
    plan = planned(model, "bezier")
    for restarts in ((), (9,)):
        _, whole = at_once(plan, model, restarts)
        np.testing.assert_allclose(
            whole.at(FRACTIONS), flown_by_scipy(plan, model, restarts), rtol=0, atol=1e-8
        )


def test_long_intervals_are_cut() -> None:
    """One step of 0.3 s cannot be exact: pieces are, also for what each interval misses from its planned state."""
    model = MODELS["racer"]
    plan = planned(model, "linear", step=0.3, strength=0.005)
    alone, whole = at_once(plan, model, (9,))
    assert len(whole.pieces.interval) > plan.intervals
    exact = sequential.flight(plan, model.plant(), FRACTIONS, (9,), 1e-13, FAR)
    np.testing.assert_allclose(whole.at(FRACTIONS), exact, rtol=0, atol=1e-8)
    every = range(1, plan.intervals)
    exact = sequential.flight(plan, model.plant(), FRACTIONS, every, 1e-13, FAR)
    np.testing.assert_allclose(alone.at(FRACTIONS), exact, rtol=0, atol=1e-8)
    np.testing.assert_allclose(alone.at(FRACTIONS)[:, -1], alone.ends, rtol=0, atol=1e-14)


def test_one_long_interval_costs_the_others_nothing() -> None:
    model = MODELS["arm"]
    plan = planned(model)
    later = np.arange(N + 1) > 7
    plan = replace(plan, time=plan.time + 0.4 * later)
    alone, _ = at_once(plan, model)
    counted = np.bincount(alone.pieces.interval, minlength=N)
    assert counted[7] > 1 and np.all(np.delete(counted, 7) == 1)


def test_a_flight_far_from_its_plan_is_found() -> None:
    """Planned to stand still, flown with one motor a fifth too strong: a tumble that ends metres away."""
    model = MODELS["arm"]
    plan = planned(model, strength=0.0, off=0.0, step=0.06)
    plan = replace(plan, inputs=plan.inputs * np.array([1.2, 1.0, 1.0, 1.0, 1.0]))
    found = replay(plan, model.plant())
    reached = np.hstack([found.configuration, found.velocity])[1:].reshape(N, 10, -1)
    exact = sequential.flight(plan, model.plant(), FRACTIONS, (), 1e-12, FAR)
    assert np.max(np.abs(reached - np.hstack([plan.configuration, plan.velocity])[0])) > 5
    np.testing.assert_allclose(reached, exact, rtol=0, atol=1e-8)


def test_a_rough_flight_is_near() -> None:
    """RK4 once per interval: an error of a thousandth at most here, and exactly the plan where it begins again."""
    model = MODELS["arm"]
    plan = planned(model, "linear")
    start = np.hstack([plan.configuration, plan.velocity])[:-1]
    found = roughly(Pieces.of(plan, model.plant()), start, np.array([0, 9]))
    flown = sequential.flight(plan, model.plant(), np.ones(1), (9,), TOLERANCE, FAR)[:, 0]
    np.testing.assert_array_equal(found[[0, 9]], start[[0, 9]])
    np.testing.assert_allclose(np.delete(found[1:], 8, axis=0), np.delete(flown[:-1], 8, axis=0), atol=1e-3)


def test_what_leaves_the_room_is_not_settled() -> None:
    """Free fall for a quarter of an hour ends faster than any room allows; the flight in turn says when."""
    model = MODELS["racer"]
    plan = planned(model, strength=0.0, off=0.0)
    plan = replace(plan, inputs=0 * plan.inputs, time=3000 * plan.time)
    start = np.hstack([plan.configuration, plan.velocity])[:-1]
    shot = Shot.of(Pieces.of(plan, model.plant()), start)
    assert settled(shot, np.zeros(1, int), TOLERANCE, FAR) is None
    missed, flight = fly(plan, model.plant())
    assert flight.broken_at == pytest.approx(9.0)
    assert np.isnan(missed.configuration).all()


def pendulum(x: float, y: Array) -> Array:
    """Driven and damped; n = 2, any batch."""
    q, v = y[..., 0], y[..., 1]
    return np.stack([v, -4 * np.sin(q) - 0.3 * v + np.cos(3 * x)], axis=-1)


STARTS = np.array([[0.1, 0.0], [2.0, -1.0], [-3.0, 4.0]])


def test_a_step_is_that_of_scipy() -> None:
    """End and dense output to rounding, for each state of the batch as if it were alone."""
    made = dop853.step(pendulum, STARTS)
    x = np.linspace(0, 1, 7)
    curves = made.curve()
    for k, start in enumerate(STARTS):
        solver = DOP853(pendulum, 0.0, start, 1.0, first_step=1.0, rtol=1e3, atol=1e3)
        solver.step()
        assert solver.t == 1.0
        np.testing.assert_allclose(made.end[k], solver.y, rtol=0, atol=1e-13)
        mine = dop853.along(curves[:, [k] * len(x)], x)
        np.testing.assert_allclose(mine, solver.dense_output()(x).T, rtol=0, atol=1e-12)


def test_the_estimate_is_that_of_scipy() -> None:
    """Of one state at a time, absolute and relative tolerance alike; `scale` is 1e-6 (1 + |y|)."""
    made = dop853.step(pendulum, STARTS)
    for k, start in enumerate(STARTS):
        solver = DOP853(pendulum, 0.0, start, 1.0, first_step=1.0, rtol=1e3, atol=1e3)
        solver.step()
        scale = 1e-6 * (1 + np.maximum(np.abs(start), np.abs(solver.y)))
        expected = solver._estimate_error_norm(solver.K, 1.0, scale)
        assert made.error(1e-6)[k] == pytest.approx(expected, rel=1e-6)


def test_orders_and_the_estimate() -> None:
    """A step of half the length: 2^9 times exacter at its end, 2^8 inside; the estimate is above the error and falls with it."""
    ends, inside, guessed = [], [], []
    for length in (0.8, 0.4):
        made = dop853.step(lambda x, y, h=length: h * pendulum(h * x, y), STARTS)
        exact = [
            solve_ivp(pendulum, (0, length), y, "DOP853", [0.3 * length, length], rtol=1e-13, atol=1e-14).y.T
            for y in STARTS
        ]
        middle = dop853.along(made.curve(), np.full(3, 0.3))
        inside.append(np.max(np.abs(middle - np.array(exact)[:, 0])))
        ends.append(np.max(np.abs(made.end - np.array(exact)[:, 1])))
        guessed.append(np.max(made.error(1.0)))
    assert 2**8 < ends[0] / ends[1] < 2**11
    assert 2**7 < inside[0] / inside[1] < 2**10
    assert 2**7 < guessed[0] / guessed[1] < 2**11
    assert guessed[0] > ends[0] / 5 and guessed[1] > ends[1] / 5


def test_the_error_of_each_state_is_its_own() -> None:
    """One that is hard to fly does not excuse another, nor the reverse."""
    together = dop853.step(pendulum, STARTS).error(1e-6)
    alone = [dop853.step(pendulum, start[None]).error(1e-6)[0] for start in STARTS]
    np.testing.assert_allclose(together, alone, rtol=1e-6)
    assert together.max() > 10 * together.min()
    still = dop853.step(lambda x, y: 0 * y, STARTS).error(1e-6)
    np.testing.assert_array_equal(still, 0.0)


def test_a_wrong_digit_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = dop853_coefficients.B.copy()
    wrong[7] += 1e-9
    monkeypatch.setattr(dop853_coefficients, "B", wrong)
    with pytest.raises(ValueError, match="order is below 8"):
        dop853_coefficients._check()
