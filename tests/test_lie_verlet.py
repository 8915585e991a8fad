"""The variational integrator in unit quaternions: what it keeps, how it converges, and what it agrees with."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import composing
import numpy as np
import pytest
from flights import TABLE_I, table_one
from scipy.spatial.transform import Rotation

from benchbench.conformance.checks.initial_value import fly, integrate, one_phase, told, transcribe
from benchbench.ground.arrays import Array
from benchbench.ground.errors import IncompatibleCase
from benchbench.ocp.model import ExplicitModel, LagrangianModel, ManifoldModel, Model
from benchbench.ocp.plan import Plan
from benchbench.run import pipeline
from benchbench_plugins.dynamics.lie_verlet import LieVerlet
from benchbench_plugins.dynamics.verlet import Verlet
from benchbench_plugins.models.aerial_manipulator import AerialManipulator
from benchbench_plugins.models.attitude import UnitQuaternion
from benchbench_plugins.models.attitude_space import AttitudeSpace
from benchbench_plugins.models.quadrotor import Quadrotor

NUMBERS = {
    "mass": 0.85, "inertia": (0.01, 0.012, 0.017), "lever": 0.15, "torque_coefficient": 0.05,
    "motor_force": (0.0, 6.8794), "body_rate": (15.0, 15.0, 3.0),
}  # fmt: skip
RACER, RACER_IN_ANGLES = (Quadrotor("racer", **NUMBERS, attitude=kind) for kind in ("quaternion", "euler"))
ARM, ARM_IN_ANGLES = AerialManipulator("arm", attitude="quaternion", **TABLE_I), table_one()
TILTED = Rotation.from_euler("ZYX", [0.4, -0.2, 0.3])
TURN = np.array([0.8, -0.5, 1.1])
BOTH = pytest.mark.parametrize("model", [RACER, ARM], ids=["quadrotor", "aerial manipulator"])


def moving(model: Model) -> tuple[Array, Array]:
    """The same tilted and turning start in either coordinates."""
    rest = len(model.configuration.names) - (6 if "roll" in model.configuration.names else 7)
    arm, arm_rate = [1.4] * rest, [0.6] * rest
    if "qw" in model.configuration.names:
        q = np.array([0.1, -0.2, 1.0, *TILTED.as_quat(scalar_first=True), *arm])
        return q, np.array([0.3, 0.2, -0.1, *TURN, *arm_rate])
    yaw, pitch, roll = TILTED.as_euler("ZYX")
    e = np.array(
        [
            [1, 0, -np.sin(pitch)],
            [0, np.cos(roll), np.sin(roll) * np.cos(pitch)],
            [0, -np.sin(roll), np.cos(roll) * np.cos(pitch)],
        ]
    )
    rates = np.linalg.solve(e, TURN)
    return np.array([0.1, -0.2, 1.0, roll, pitch, yaw, *arm]), np.array([0.3, 0.2, -0.1, *rates, *arm_rate])


def wave(model: Model, size: float = 0.1) -> object:
    hover = model.hover()
    return lambda t: hover + size * np.sin(6 * t[:, None] + np.arange(len(hover)))


def flight(model: Model, intervals: int, seconds: float, signal: object, dynamics: object = None) -> Plan:
    """By the transcription, from the moving start."""
    ours = transcribe(dynamics or LieVerlet(), model, one_phase(intervals, seconds))
    order = told(ours, *moving(model), signal)
    return integrate(ours, order, fly(model, order))


def turned(plan: Plan) -> Rotation:
    if "qw" in plan.coordinate_names:
        return Rotation.from_quat(plan.configuration[:, 3:7], scalar_first=True)
    return Rotation.from_euler("ZYX", plan.configuration[:, [5, 4, 3]])


def apart(a: Plan, b: Plan) -> float:
    """Largest distance in m, rad between two flights in any coordinates, at the nodes of the coarser."""
    stride = a.intervals // b.intervals
    angle = np.max((turned(a)[::stride].inv() * turned(b)).magnitude())
    others = a.configuration[::stride, :3] - b.configuration[:, :3]
    return float(max(angle, np.max(np.abs(others))))


@BOTH
def test_second_order_against_an_independent_integrator(model: Model) -> None:
    """Forced, turning, with a gyroscopic moment; configurations and velocities at all nodes."""
    errors = []
    for intervals in (10, 20, 40):
        got = flight(model, intervals, 0.4, wave(model))
        exact = fly(model, got)
        gaps = [np.abs(getattr(got, k) - getattr(exact, k)).max() for k in ("configuration", "velocity")]
        errors.append(max(gaps))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(orders > 1.8), (errors, orders)


@BOTH
def test_quaternions_keep_length_one(model: Model) -> None:
    plan = flight(model, 40, 0.8, wave(model))
    np.testing.assert_allclose(np.linalg.norm(plan.configuration[:, 3:7], axis=1), 1.0, rtol=0, atol=1e-12)
    assert (turned(plan)[0].inv() * turned(plan)[-1]).magnitude() > 0.5


@pytest.mark.parametrize("angles", [RACER_IN_ANGLES, ARM_IN_ANGLES], ids=["quadrotor", "aerial manipulator"])
def test_agrees_with_verlet_in_angles_to_second_order(angles: Model) -> None:
    model = RACER if isinstance(angles, Quadrotor) else ARM
    gaps = [
        apart(
            flight(model, n, 0.4, wave(model)), flight(angles, n, 0.4, wave(angles), Verlet())
        )
        for n in (10, 20, 40)
    ]  # fmt: skip
    orders = np.log2(np.array(gaps[:-1]) / gaps[1:])
    assert gaps[-1] < 1e-3
    assert np.all(orders > 1.7), (gaps, orders)


def momenta(model: Model, plan: Plan) -> tuple[Array, Array]:
    """Linear (n, 3) and angular (n, 3) momentum in the world, the latter about the origin, by AD on L."""
    q, v = ca.SX.sym("q", len(model.configuration.names)), ca.SX.sym("v", len(model.velocity.names))
    dual = ca.Function("p", [q, v], [ca.gradient(model.lagrangian(q, v), v)])
    p = np.array([np.asarray(dual(*s)).ravel() for s in zip(plan.configuration, plan.velocity, strict=True)])
    spin = turned(plan).apply(p[:, 3:6])
    return p[:, :3], spin + np.cross(plan.configuration[:, :3], p[:, :3])


@pytest.mark.parametrize("kind", ["quadrotor", "aerial manipulator"])
def test_without_forces_both_momenta_stay(kind: str) -> None:
    """Discrete Noether theorem: L_d is invariant under translations and rotations, to rounding at any step."""
    tiny = 1e-9
    model: Model = (
        Quadrotor("free", **NUMBERS | {"gravity": tiny})
        if kind == "quadrotor"
        else AerialManipulator("free", attitude="quaternion", **TABLE_I | {"gravity": tiny})
    )
    plan = flight(model, 25, 1.0, lambda t: np.zeros((len(t), len(model.inputs.names))))
    linear, angular = momenta(model, plan)
    np.testing.assert_allclose(linear, np.tile(linear[0], (26, 1)), atol=1e-8)
    np.testing.assert_allclose(angular, np.tile(angular[0], (26, 1)), atol=1e-8)
    assert np.ptp(plan.velocity[:, 3:6], axis=0).max() > 0.01, "the body rates do change"


def energy_error(model: Model, seconds: float, step: float) -> Array:
    """Relative to the kinetic energy, at each node of a free flight."""
    plan = flight(
        model, round(seconds / step), seconds, lambda t: np.zeros((len(t), len(model.inputs.names)))
    )
    q, v = ca.SX.sym("q", len(model.configuration.names)), ca.SX.sym("v", len(model.velocity.names))
    lagrangian = model.lagrangian(q, v)
    energy = ca.Function("energy", [q, v], [ca.dot(v, ca.gradient(lagrangian, v)) - lagrangian])
    along = np.array([float(energy(*s)) for s in zip(plan.configuration, plan.velocity, strict=True)])
    return np.abs(along - along[0]) / along[0]


def test_energy_stays_bounded_over_many_turns() -> None:
    """Body and arm turn freely for 4 s: the error does not drift, and quarters with half the step."""
    model = AerialManipulator("free", attitude="quaternion", **TABLE_I | {"gravity": 1e-9})
    errors = []
    for step in (0.05, 0.025):
        off = energy_error(model, 4.0, step)
        half = len(off) // 2
        assert off[half:].max() < 1.2 * off[:half].max()
        errors.append(off.max())
    assert errors[0] > 1e-5, "there is an error"
    assert np.log2(errors[0] / errors[1]) > 1.8


def test_inputs_and_forces_of_every_kind_converge() -> None:
    for dynamics in (LieVerlet("nodal"), LieVerlet("averaged"), LieVerlet(forces="simpson")):
        errors = []
        for intervals in (10, 20):
            got = flight(RACER, intervals, 0.4, wave(RACER), dynamics)
            errors.append(np.abs(got.velocity - fly(RACER, got).velocity).max())
        assert np.log2(errors[0] / errors[1]) > 1.8, (dynamics, errors)


@pytest.mark.parametrize("angle", [0.01, 0.3, 0.9])
def test_the_difference_of_quaternions_is_the_rotation_vector(angle: float) -> None:
    start, turn = Rotation.from_rotvec([0.5, -1.0, 0.3]), angle * np.array([2, -1, 2]) / 3
    pair = (start, start * Rotation.from_rotvec(turn))
    places = [np.concatenate([np.zeros(3), r.as_quat(scalar_first=True)]) for r in pair]
    found = np.asarray(ca.DM(RACER.space.difference(*(ca.SX(place) for place in places)))).ravel()
    np.testing.assert_allclose(found[3:], turn, atol=2e-6)


class Damped(ExplicitModel, LagrangianModel, ManifoldModel):
    """The racing quadrotor with a drag on its body rates, in symbols and in its plant."""

    drag = 0.05

    def __init__(self) -> None:
        self.name = "damped"

    def __getattribute__(self, name: str) -> object:
        own = name in ("drag", "name", "force", "acceleration", "plant", "_whole") or name.startswith("__")
        return super().__getattribute__(name) if own else getattr(RACER, name)

    def _slow(self, v: ca.SX | Array) -> ca.SX | Array:
        return -self.drag * v

    def force(self, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        return RACER.force(q, v, u) + ca.vertcat(0, 0, 0, -Damped.drag * v[3:])

    def acceleration(self, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        drag = ca.vertcat(0, 0, 0, -Damped.drag * v[3:] / ca.DM(NUMBERS["inertia"]))
        return RACER.acceleration(q, v, u) + drag

    def plant(self) -> object:
        plant = RACER.plant()
        undamped = plant.acceleration

        def acceleration(q: Array, v: Array, u: Array) -> Array:
            a = undamped(q, v, u)
            a[..., 3:] -= Damped.drag * v[..., 3:] / np.array(NUMBERS["inertia"])
            return a

        plant.acceleration = acceleration  # type: ignore[method-assign]
        return plant

    configuration = velocity = inputs = space = lagrangian = None  # type: ignore[assignment]
    tool = nose = hover = None  # type: ignore[assignment]


def test_forced_and_damped_flights_converge() -> None:
    model = Damped()
    errors = []
    for intervals in (10, 20, 40):
        got = flight(model, intervals, 0.4, wave(model))
        errors.append(np.abs(got.velocity - fly(model, got).velocity).max())
    assert np.all(np.log2(np.array(errors[:-1]) / errors[1:]) > 1.8), errors
    slower = np.linalg.norm(got.velocity[-1, 3:]) / np.linalg.norm(
        flight(RACER, 40, 0.4, wave(RACER)).velocity[-1, 3:]
    )
    assert slower < 0.9, "the drag is felt"


def test_wrong_reaction_to_rotation_is_noticed() -> None:
    """Broken on purpose: derivatives of the difference as if rotations added up. First order, not second."""

    def difference(a: ca.SX, b: ca.SX) -> ca.SX:
        return 2 * (a[0] * b[1:] - b[0] * a[1:] + ca.cross(a[1:], b[1:]))  # world frame, not body

    class Flat(LagrangianModel, ManifoldModel):
        configuration = velocity = inputs = lagrangian = None  # type: ignore[assignment]
        tool = nose = hover = plant = force = None  # type: ignore[assignment]

        def __getattribute__(self, name: str) -> object:
            own = name == "space" or name.startswith("__")
            return super().__getattribute__(name) if own else getattr(RACER, name)

        @property
        def space(self) -> AttitudeSpace:
            attitude = UnitQuaternion()
            attitude.difference = difference  # type: ignore[method-assign]
            return AttitudeSpace(attitude, joints=0, heading_free=True)

    errors = []
    for intervals in (10, 20):
        got = flight(Flat(), intervals, 0.2, wave(RACER))
        errors.append(np.abs(got.velocity - fly(RACER, got).velocity).max())
    assert np.log2(errors[0] / errors[1]) < 1.5


@pytest.mark.slow
def test_a_handover_in_quaternions_takes_as_long_as_in_angles() -> None:
    told_both = ("+scenario=static", "strategy=phases", "strategy.margin=0", "scenario.intervals=60")
    found = [
        pipeline.run(composing.case_of(*told_both, f"vehicle={vehicle}", f"dynamics={dynamics}"))
        for vehicle, dynamics in (("table1", "verlet"), ("table1_quaternion", "lie_verlet"))
    ]
    angles, quaternions = (done.result.plan for done in found)
    assert quaternions.travel_time == pytest.approx(angles.travel_time, abs=2e-3)
    np.testing.assert_allclose(np.linalg.norm(quaternions.configuration[:, 3:7], axis=1), 1, atol=1e-10)
    judged = found[1].certificate
    limited = {check.name for check in judged.checks}
    assert {"planned_output", "replay_angle", "contact_position"} <= limited


@pytest.mark.usefixtures("brief_replays")
def test_a_tilted_plan_in_quaternions_is_refused() -> None:
    """Roll, pitch and Euler rates keep their limits as outputs: the certificate says so by name."""
    from benchbench.certificate.certify import certify

    case = composing.case_of(
        "+scenario=static", "strategy=phases", "strategy.margin=0", "scenario.intervals=20",
        "vehicle=table1_quaternion", "dynamics=lie_verlet",
    )  # fmt: skip
    plan = pipeline.run(case).result.plan
    q = plan.configuration.copy()
    q[7, 3:7] = Rotation.from_euler("ZYX", [0.0, 0.9, 0.0]).as_quat(scalar_first=True)
    reasons = [
        check.reason
        for check in certify(replace(plan, configuration=q), case.scenario, case.model, case.limits).checks
        if check.name == "planned_output"
    ]
    assert "'pitch'" in reasons[0] and "node 7" in reasons[0]


def test_verlet_refuses_quaternions() -> None:
    with pytest.raises(IncompatibleCase, match="adds coordinates") as caught:
        pipeline.run(composing.case_of("+scenario=static", "vehicle=table1_quaternion"))
    assert "lie_verlet" in str(caught.value)


@pytest.mark.parametrize(("forces", "nodes"), [("simpson", 20), ("trapezoid", 50)])
def test_replay_errors_of_races_at_the_declared_nodes(forces: str, nodes: int) -> None:
    """At most 1 cm per segment; the time is RK4's at as many nodes."""
    told_both = (
        "+scenario=race",
        "vehicle=race_ramp",
        "scenario.gates=2",
        f"scenario.nodes_per_gate={nodes}",
    )
    lie, rk4 = (
        pipeline.run(composing.case_of(*told_both, f"dynamics={name}")).record
        if name == "rk4"
        else pipeline.run(
            composing.case_of(*told_both, f"dynamics={name}", f"dynamics.forces={forces}")
        ).record
        for name in ("lie_verlet", "rk4")
    )
    assert lie["replay_drift_position_m"] < 0.01
    assert lie["status"] == rk4["status"] == "certified"
    assert lie["travel_time_s"] == pytest.approx(rk4["travel_time_s"], rel=1e-3)
