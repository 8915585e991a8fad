"""A certified plan flown in closed loop: tracking in a perfect world, the judge's reasons, records, and failures of controllers."""

from __future__ import annotations

import csv
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchbench.analysis.binomial import exact_bound
from benchbench.certificate.replay import replay
from benchbench.cli.report_content import truth as truth_of
from benchbench.flight.campaign import Campaign
from benchbench.flight.columns import columns, table
from benchbench.flight.controller import PERIOD, Controller, Known
from benchbench.flight.course import Control, Course, Steady
from benchbench.flight.errand import errand
from benchbench.flight.from_plan import reference_of
from benchbench.flight.judge import judge
from benchbench.flight.loop import Log, fly
from benchbench.flight.mismatch import Mismatch
from benchbench.flight.payload import Weighing
from benchbench.flight.predictor import Predictor, Seen
from benchbench.flight.reference import Reference, tip
from benchbench.flight.residual import Correction
from benchbench.flight.sensed import Command, Sensed
from benchbench.flight.sensors import Sensors
from benchbench.flight.statics import hover
from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput, BenchBenchError, Unavailable
from benchbench.ocp.airframe import FlownModel
from benchbench.ocp.motion import Motion
from benchbench.planning.case import Case
from benchbench.report.flights import flights_figure
from benchbench.report.html.plans.view import view
from benchbench.report.scene import scene
from benchbench.run import config, pipeline
from benchbench.run.filming import film_flight
from benchbench.run.flying import campaign
from benchbench_plugins.controllers.receding import Receding
from benchbench_plugins.predictors.constant_turn import ConstantTurn

pytest.importorskip("mujoco", reason="mujoco is not installed")
pytest.importorskip("daqp", reason="daqp is not installed")
imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg", reason="imageio-ffmpeg is not installed")
SAMPLED = ("time", "state", "inputs", "acceleration", "target")
GENTLE = ("+scenario=circle", "+scenario/contact=approach", "residual=observer")


def asked(*overrides: str) -> tuple[Case, Campaign]:
    cfg, chosen = config.composed(*GENTLE, *overrides)
    case, found = config.build(cfg, chosen), campaign(cfg, chosen)
    assert isinstance(case, Case) and found is not None
    return case, found


@pytest.fixture(scope="module")
def flown() -> pipeline.Run:
    """A gentle plan, and two flights of it in different worlds."""
    case, flights = asked("flights=2", "mismatch=lab")
    return pipeline.run(case, labels={"run_id": "flown"}, campaign=flights)


@pytest.fixture(scope="module")
def reference(flown: pipeline.Run) -> Reference:
    assert flown.flights is not None
    return flown.flights.reference


def frame(run: pipeline.Run) -> FlownModel:
    assert isinstance(run.case, Case) and isinstance(run.case.model, FlownModel)
    return run.case.model


def test_plan_is_certified_flown_and_told(flown: pipeline.Run, tmp_path: Path) -> None:
    record = flown.record
    assert record["certified"] and (record["flights"], record["flights_succeeded"]) == (2, 2)
    assert record["flights_low_exact"] == pytest.approx(0.05**0.5)
    assert (record["world"], record["residual"], record["mismatch"]) == ("mujoco", "observer", "lab")
    assert record["flight_error_before_m"] < 0.02
    paths = pipeline.write(flown, tmp_path / "run", tmp_path, "", picture=False)
    with paths["flights"].open() as file:
        rows = list(csv.DictReader(file))
    assert [row["success"] for row in rows] == ["True", "True"]
    assert rows[0]["mismatch.mass"] != rows[1]["mismatch.mass"]


@pytest.mark.parametrize(("autopilot", "most"), [("px4", 0.008), ("torque_ff", 0.003)])
def test_perfect_world_is_tracked(
    flown: pipeline.Run, reference: Reference, autopilot: str, most: float
) -> None:
    _, flights = asked("residual=none", "mismatch=none", f"autopilot={autopilot}")
    one = flights.once(reference, frame(flown).airframe, 0)
    assert one.verdict.success and one.verdict.error_before <= most


def test_reference_is_the_replay(flown: pipeline.Run, reference: Reference) -> None:
    """At the plan's nodes, by the certificate's own plant; before and after it hovers at the ends."""
    case, flight, plant = flown.case, flown.certificate.flight, frame(flown).plant()
    assert isinstance(case, Case) and flight is not None
    position, _ = plant.tool(flight.configuration, flight.velocity)
    a = frame(flown).airframe
    found, _ = tip(reference.state, a.arm_offset, a.arm_length)
    at = np.stack([np.interp(flight.time, reference.time, column) for column in found.T], axis=-1)
    assert np.abs(at - position).max() < 1e-4
    for end in (0, -1):
        assert not reference.state[end, 8:].any()
        u = hover(a, float(reference.state[end, 7]))
        np.testing.assert_allclose(reference.inputs[end], u)
        q = np.array([0, 0, 1, 0, 0, 0, reference.state[end, 7]])
        np.testing.assert_allclose(plant.acceleration(q, np.zeros(7), u), 0, atol=1e-9)


def test_a_replay_that_starts_again_has_no_jump(flown: pipeline.Run) -> None:
    case, plan = flown.case, flown.result.plan
    assert isinstance(case, Case)
    again = replay(plan, frame(flown).plant(), restart_seconds=1.0)
    assert again.restarts
    made = reference_of(plan, again, frame(flown), errand(case.scenario))
    way = np.diff(made.state[:, :3], axis=0) / made.step
    between = (made.state[1:, 8:11] + made.state[:-1, 8:11]) / 2
    assert np.abs(way - between).max() < 0.02


def test_a_controller_goes_on_with_another_reference(flown: pipeline.Run, reference: Reference) -> None:
    """Prepared anew every tenth of a second for the same reference, it commands what it does without."""
    _, flights = asked("mismatch=lab")
    short = replace(reference, **{name: getattr(reference, name)[:1300] for name in SAMPLED})  # type: ignore[arg-type]
    a, drawn = frame(flown).airframe, flights.mismatch.draw(2)

    def begun(before: Control | None, correction: Correction) -> Control:
        return flights.controller.prepare(Known(short, a, flights.rig, before), correction, _nothing)

    class Again:
        reference = short

        def __init__(self) -> None:
            self.correction = flights.residual.learn([])()
            self.step = begun(None, self.correction)

        def control(self, now: float) -> Control:
            if round(now / PERIOD) % 5 == 0:
                self.step = begun(self.step, self.correction)
            return self.step

    def fly_along(course: Course) -> Log:
        world = flights.world.prepare(short, a, flights.rig, drawn)
        return fly(
            course, world, flights.autopilot.prepare(Known(short, a, flights.rig)), Sensors(drawn, 9.0)
        )

    one = fly_along(Steady(short, begun(None, flights.residual.learn([])())))
    np.testing.assert_allclose(fly_along(Again()).state, one.state, atol=1e-9)


def _nothing(sensed: Sensed, command: Command | None, along: float) -> float:
    return 0.0


def test_a_predicted_target_is_met(flown: pipeline.Run, reference: Reference) -> None:
    """Seen with noise, planned anew ten times a second from where the plan before is: without a jump, and told in the record."""
    case, flights = asked("mismatch=lab", "predictor=constant_turn", "flights=1")
    flights.check(case.scenario, case.model)
    assert flown.certificate.flight is not None
    _, found = flights.fly(flown.result.plan, flown.certificate.flight, case)
    one = found[0]
    assert one.verdict.success and len(one.replan_cpu) > 10 and one.refused == 0
    r = one.reference
    np.testing.assert_array_equal(r.state[: r.row(0.0), :3], np.tile(reference.state[0, :3], (r.row(0.0), 1)))
    way, between = np.diff(r.state[:, :3], axis=0) / r.step, (r.state[1:, 8:11] + r.state[:-1, 8:11]) / 2
    assert np.abs(way - between).max() < 1e-3, "places and speeds belong together, also where a plan begins"
    turned = np.abs(np.sum(r.state[1:, 3:7] * r.state[:-1, 3:7], axis=1) - 1)
    assert turned.max() < 1e-3, "no quaternion changes its sign"
    told = columns(flights, found)
    assert (told["predictor"], told["replans"], told["replans_refused"]) == (
        "constant_turn",
        len(one.replan_cpu),
        0,
    )
    assert told["replan_cpu_p50_s"] > 0
    row = next(csv.DictReader(table(found, "constant_turn").splitlines()))
    assert (row["predictor"], row["replans"]) == ("constant_turn", str(len(one.replan_cpu)))
    short = replace(reference, **{name: getattr(reference, name)[:-1200] for name in SAMPLED})
    assert len(one.log.time) > len(short.time), "a flight may take longer than its plan"
    flights_figure(short, found, frame(flown).airframe, flights.limits, "").canvas.draw()


def test_a_controller_knows_the_target_as_it_was_predicted(flown: pipeline.Run) -> None:
    """A predictor that thinks the target is 15 mm higher: so does the controller, while the judge keeps the truth."""

    class High(Predictor):
        def predict(self, seen: Seen) -> Motion:
            return ConstantTurn().predict(replace(seen, position=seen.position + np.array([0.0, 0.0, 0.015])))

    told: list[Reference] = []

    class Listening(Controller):
        def prepare(self, known: Known, correction: Correction, weighing: Weighing) -> Control:
            told.append(known.reference)
            return inner.prepare(known, correction, weighing)

    case, flights = asked("mismatch=none", "flights=1")
    inner, plan = flights.controller, flown.certificate.flight
    assert plan is not None
    believing = replace(flights, predictor=High(), controller=Listening())
    one, last = believing.fly(flown.result.plan, plan, case)[1][0].reference, told[-1]
    assert len(told) > 10
    higher = (last.target - one.target)[last.row(0.5) :, 2]
    np.testing.assert_allclose(higher, 0.015, atol=1e-3)


def test_a_predictor_that_raises_costs_one_flight(flown: pipeline.Run) -> None:
    class Raises(Predictor):
        def predict(self, seen: Seen) -> Motion:
            if seen.time[0] < -1.99 - 1e-9 and len(seen.time) > 130:
                raise RuntimeError("lost it")
            return ConstantTurn().predict(seen)

    case, flights = asked("mismatch=lab", "flights=1")
    broken = replace(flights, predictor=Raises())
    assert flown.certificate.flight is not None
    _, found = broken.fly(flown.result.plan, flown.certificate.flight, case)
    assert found[0].verdict.reasons == ("controller",) and "RuntimeError: lost it" in found[0].verdict.detail


def test_two_worlds_agree(flown: pipeline.Run, reference: Reference) -> None:
    """MuJoCo's and the ordinary differential equations', both under the same mismatch, until the ball is met."""
    logs = [
        asked("mismatch=lab", f"world={world}")[1].once(reference, frame(flown).airframe, 1).log
        for world in ("mujoco", "ode")
    ]
    before = logs[0].time < reference.window[0] - 0.2
    one, other = (log.state[: before.sum(), :3] for log in logs)
    assert np.abs(one - other).max() < 2e-3


class Failing(Controller):
    """Hands on what another controller commands, spoilt after half a second."""

    def __init__(self, own: Controller, spoil: Callable[[Command], Command]) -> None:
        self.own, self.spoil = own, spoil

    def prepare(
        self, known: Known, correction: Correction, weighing: Weighing
    ) -> Callable[[Sensed, float], Command]:
        step = self.own.prepare(known, correction, weighing)

        def control(sensed: Sensed, now: float) -> Command:
            command = step(sensed, now)
            return self.spoil(command) if now > 0.5 else command

        return control


def raises(command: Command) -> Command:
    raise RuntimeError("no idea")


def nothing(command: Command) -> Command:
    return replace(command, thrust=float("nan"))


def falls(command: Command) -> Command:
    return replace(command, thrust=0.0)


def climbs(command: Command) -> Command:
    return replace(command, thrust=100.0)


@pytest.mark.parametrize(
    ("spoil", "reason", "detail"),
    [
        (raises, "controller", "no idea"),
        (nothing, "controller", "no number"),
        (falls, "touched", "ground"),
        (climbs, "lost", ""),
    ],
)
def test_a_failing_controller_costs_one_flight(
    flown: pipeline.Run, reference: Reference, spoil: Callable[[Command], Command], reason: str, detail: str
) -> None:
    _, flights = asked("mismatch=none")
    broken = replace(flights, controller=Failing(flights.controller, spoil))
    one = broken.once(reference, frame(flown).airframe, 0)
    assert reason in one.verdict.reasons and detail in one.verdict.detail


class Watched(Controller):
    """Another controller, and where it thought the vehicle would be, (10,) each, at what times."""

    def __init__(self, own: Controller) -> None:
        self.own, self.thought = own, dict[float, Array]()

    def prepare(
        self, known: Known, correction: Correction, weighing: Weighing
    ) -> Callable[[Sensed, float], Command]:
        step = self.own.prepare(known, correction, weighing)
        assert isinstance(step, Receding)

        def control(sensed: Sensed, now: float) -> Command:
            command = step(sensed, now)
            self.thought[now + step.estimate.latency] = step.program.prediction.first.copy()
            return command

        return control


def test_without_news_the_model_knows_where_the_vehicle_is(flown: pipeline.Run, reference: Reference) -> None:
    """0.3 s in a world that differs by the motors' lag alone: 25 mm/s off if the plan's thrust is thought to come in time."""
    more = ("mismatch.motor_lag=[0.03,0.03]", "mismatch.blind=[0.3,0.3]", "mismatch.delay=[0.01,0.01]")
    _, flights = asked("mismatch=none", *more)
    watched = Watched(flights.controller)
    log = replace(flights, controller=watched).once(reference, frame(flown).airframe, 0).log
    ends = reference.window[0] - 0.2
    off = [
        log.state[np.argmin(np.abs(log.time - t)), 8:11] - thought[7:]
        for t, thought in watched.thought.items()
        if ends - 0.1 < t < ends + 0.02
    ]
    assert len(off) > 4 and np.linalg.norm(off, axis=1).max() < 0.012


class Unprepared(Controller):
    """Cannot begin."""

    def prepare(
        self, known: Known, correction: Correction, weighing: Weighing
    ) -> Callable[[Sensed, float], Command]:
        raise RuntimeError("not today")


@pytest.mark.parametrize(
    ("spoil", "residual", "detail"),
    [
        (True, "none", "preparing it raised RuntimeError: not today"),
        (False, "none", "the controller raised RuntimeError: no idea"),
        (False, "gp", "preparing it raised BadInput: residual: 0 samples were flown"),
    ],
)
def test_what_fails_before_the_first_command_costs_one_flight(
    flown: pipeline.Run, reference: Reference, spoil: bool, residual: str, detail: str, tmp_path: Path
) -> None:
    """Also where the training flight is such a one; the picture of a flight that never was has its place."""
    from benchbench.flight.columns import flights as told
    from benchbench.report.flights import draw_flights

    _, flights = asked("mismatch=lab", f"residual={residual}", "flights=1")

    class Silent(Controller):
        def prepare(
            self, known: Known, correction: Correction, weighing: Weighing
        ) -> Callable[[Sensed, float], Command]:
            return lambda sensed, now: raises(Command(now, 0, (0, 0, 0), (0, 0, 0), (0, 0, 0), (0, 0, 0)))

    broken = replace(flights, controller=Unprepared() if spoil else Silent())
    one = broken.once(reference, frame(flown).airframe, 0)
    assert one.verdict.reasons == ("controller",) and one.verdict.detail.startswith(detail)
    assert told(broken, frame(flown).airframe, reference, [one]).columns["flight_reasons"] == {
        "controller": 1
    }
    draw_flights(tmp_path / "x.png", reference, [one], frame(flown).airframe, flights.limits, "")
    assert (tmp_path / "x.png").stat().st_size > 1000


def perfect(reference: Reference) -> Log:
    """A flight exactly as planned, the ball taken where the plan first touches it and carried on."""
    n = len(reference.time) - 1
    state, time = reference.state[1:].copy(), reference.time[1:]
    ball = reference.target[1:] - [0, 0, reference.ball_radius, 0, 0, 0]
    return Log(
        time=time, state=state, ball=ball, attached=time >= reference.window[0], touched=("",) * n, motors=np.zeros((n, 4)),
        commanded=np.zeros(0), rates=np.zeros((0, 3)), thrust=np.zeros(0), sensed=np.zeros((0, 15)), controller_cpu=np.full(10, 1e-3), cpu=1.0, broken="",
    )  # fmt: skip


def test_every_reason_of_the_judge(flown: pipeline.Run, reference: Reference) -> None:
    """Each from a perfect flight with one thing changed."""
    (_, flights), a = asked(), frame(flown).airframe
    good = perfect(reference)
    fast = good.ball.copy()
    fast[:, 3] += 0.4
    changes = {
        "lost": {"broken": "lost"},
        "controller": {"broken": "the controller raised"},
        "controller late": {"controller_cpu": np.full(10, 0.03)},
        "no attachment": {"attached": np.zeros(len(good.time), bool)},
        "early": {"attached": good.time >= reference.window[0] - 0.3},
        "late": {"attached": good.time >= reference.window[1] + 0.01},
        "dropped": {"attached": good.attached & (good.time < reference.window[1] + 0.5)},
        "touched": {"touched": ("stand", *good.touched[1:])},
        "too fast": {"ball": fast},
    }
    assert judge(good, reference, a, flights.limits).reasons == ()
    for reason, change in changes.items():
        found = judge(replace(good, **change), reference, a, flights.limits).reasons  # type: ignore[arg-type]
        assert reason in found, reason
    aside = reference.target.copy()
    aside[:, 3:5] = aside[:, [4, 3]] * [-1, 1]
    assert judge(good, replace(reference, target=aside), a, flights.limits).reasons == ("askew",)


def test_59_successes_prove_95_percent() -> None:
    assert exact_bound(59, 59) > 0.95 > exact_bound(58, 58)
    assert exact_bound(0, 5) == 0.0
    assert exact_bound(9, 10) == pytest.approx(0.6058, abs=1e-4)  # Clopper and Pearson's tables


def test_draws_are_those_of_the_seed_alone() -> None:
    ranges = Mismatch(mass=(-0.1, 0.1), wind=(-1, 1))
    assert str(ranges.draw(3)) == str(ranges.draw(3))
    more = Mismatch(mass=(-0.1, 0.1), wind=(-1, 1), drag=(0, 1))
    assert ranges.draw(3).mass == more.draw(3).mass  # what is drawn besides changes nothing
    masses = np.array([ranges.draw(seed).mass for seed in range(400)])
    assert abs(masses.mean()) < 0.01 and masses.min() > -0.1 and masses.max() < 0.1
    assert abs(masses.std() - 0.1 / 3**0.5) < 0.005
    wind = np.array([ranges.draw(seed).wind for seed in range(400)])
    assert abs(np.corrcoef(wind.T)[0, 1]) < 0.15


def test_a_flight_is_recorded(flown: pipeline.Run, tmp_path: Path) -> None:
    """Read back: the truth of every 20 ms from the plan's start on, and what is drawn of it."""
    import json

    from mcap.reader import make_reader

    from benchbench.flight.recording import write_flight

    assert flown.flights is not None and isinstance(flown.case, Case)
    one = flown.flights.flown[0]
    write_flight(
        tmp_path / "flight.mcap", flown.flights.reference, one, flown.case.scenario, flown.case.model, {}
    )
    with (tmp_path / "flight.mcap").open("rb") as file:
        messages = [(c.topic, m.data) for _, c, m in make_reader(file).iter_messages()]
    truth = [json.loads(data) for topic, data in messages if topic == "/truth/state"]
    assert len(truth) == sum(topic == "/scene" for topic, _ in messages) - 1
    row = int(np.argmin(np.abs(one.log.time - truth[50]["time"])))
    assert truth[50]["x"] == one.log.state[row, 0]
    contact = [json.loads(data) for topic, data in messages if topic == "/truth/contact"]
    assert next(c["time"] for c in contact if c["attached"]) == pytest.approx(
        one.verdict.attached_s, abs=0.021
    )
    told = truth_of(tmp_path)
    assert told is not None
    _on_the_page(flown, told)


def _on_the_page(flown: pipeline.Run, told: Array) -> None:
    """The truth of the flight stands beside its plan, at the slider's time."""
    assert isinstance(flown.case, Case) and flown.result.plan is not None and flown.flights is not None
    plan, log = flown.result.plan, flown.flights.flown[0].log
    shown = view(scene(plan, flown.case.scenario, flown.case.model, None, told))
    assert "end effector, in flight" in {trace.name for trace in shown.data}
    frame = shown.frames[len(shown.frames) // 2]
    tool, ball = frame.data[-2:]
    row = int(np.argmin(np.abs(log.time - float(frame.name))))
    airframe = flown.case.model.airframe if isinstance(flown.case.model, FlownModel) else None
    assert airframe is not None
    place, _ = tip(log.state[[row]], airframe.arm_offset, airframe.arm_length)
    assert [tool.x[0], tool.y[0], tool.z[0]] == pytest.approx(place[0], abs=0.01)  # a step of 20 ms
    assert [ball.x[0], ball.y[0], ball.z[0]] == pytest.approx(log.ball[row, :3], abs=0.01)


def test_a_recorded_flight_is_filmed(flown: pipeline.Run, tmp_path: Path) -> None:
    """Two pictures a second as MP4, where MuJoCo can draw (MUJOCO_GL=egl, before it is imported); else the reason is told."""
    from omegaconf import OmegaConf

    from benchbench.flight.recording import write_flight

    recording, config_file = tmp_path / "flight.mcap", tmp_path / "config.yaml"
    assert flown.flights is not None and isinstance(flown.case, Case)
    one = flown.flights.flown[0]
    write_flight(recording, flown.flights.reference, one, flown.case.scenario, flown.case.model, {})
    with pytest.raises(BadInput, match="of a run that was flown"):
        film_flight(recording, tmp_path / "flight.mp4", 2.0)
    for world, output, says in (
        ("mujoco", "flight.gif", r"\.mp4"),
        ("ode", "flight.mp4", "no pictures of itself"),
    ):
        config_file.write_text(OmegaConf.to_yaml(config.composed(*GENTLE, f"world={world}")[0]))
        with pytest.raises(BenchBenchError, match=says):
            film_flight(recording, tmp_path / output, 2.0)
    config_file.write_text(OmegaConf.to_yaml(config.composed(*GENTLE)[0]))
    try:
        made = film_flight(recording, tmp_path / "flight.mp4", 2.0)
    except Unavailable as error:
        pytest.skip(str(error))
    frames, seconds = imageio_ffmpeg.count_frames_and_secs(str(made))
    assert abs(seconds - (one.log.time[-1] - 0.0)) < 1.0 and abs(frames - 2 * seconds) <= 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["config.yaml", "flight.mcap", "flight.mp4"]


def test_the_page_shows_what_success_costs() -> None:
    """A point for each plan that was flown, its bar the Wilson interval; nothing where none was."""
    import pandas as pd

    from benchbench.report.html.charts import flights as page

    rows = pd.DataFrame(
        {
            "flights": [20, 20, None], "flights_succeeded": [10, 20, None], "flights_low": [0.3, 0.84, None],
            "flights_high": [0.7, 1.0, None], "travel_time_s": [3.0, 3.5, 2.8], "scenario": "circle",
            "residual": ["none", "observer", None], "mismatch": "lab", "certified": True,
            "flights_low_exact": [0.3, 0.86, None], "flight_reasons": [{"early": 10}, {}, None], "problem": "circle",
        }
    )  # fmt: skip
    assert page.flown(rows) and not page.flown(rows.iloc[2:])
    drawn = [trace for trace in page.chart(rows).figure.data if trace.mode == "markers"]
    assert [(list(trace.x), list(trace.y)) for trace in drawn] == [([3.0], [50.0]), ([3.5], [100.0])]
    assert list(drawn[1].error_y.arrayminus) == pytest.approx([16.0])
