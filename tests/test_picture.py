"""Picture: it shows the right numbers, marks the right times, hides nothing, and works for any model."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import final

import casadi as ca
import matplotlib as mpl
import numpy as np
import pytest
import yaml
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text
from PIL import Image

from benchbench.certificate.replay import Replay, replay
from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput
from benchbench.ocp.handover import Handover
from benchbench.ocp.model import Coordinates, LagrangianModel, Model, Plant, box
from benchbench.ocp.motion import Motion
from benchbench.ocp.plan import Plan
from benchbench.report import picture
from benchbench.report.contact_window import CLAIM, contact_windows
from benchbench.report.limits_panel import contact_panels, limit_panels
from benchbench.report.scene import scene
from benchbench.report.style import BAD, GOOD, RC
from benchbench_plugins.contacts.heading import Heading
from benchbench_plugins.contacts.position import Position
from benchbench_plugins.contacts.velocity import Velocity
from benchbench_plugins.models.aerial_manipulator import AerialManipulator
from benchbench_plugins.motions.circle import Circle
from benchbench_plugins.motions.fixed import Fixed

ROOT = Path(__file__).resolve().parents[1]
STILL, ROUND = Fixed((1.0, 0.0, 0.4)), Circle((1.1, 0, 0.4), 0.4, -0.3, np.pi / 2)


def vehicle() -> AerialManipulator:
    """Aerial manipulator with the paper's numerical parameters and round limits."""
    return AerialManipulator(
        name="test", quadrotor_mass=1.659, arm_mass=0.36, quadrotor_inertia=(0.035, 0.046, 0.07),
        arm_inertia=(0.001, 0.002, 0.001), arm_length=0.182, arm_offset=0.05, frame=0.33,
        torque_coefficient=0.013, motor_force=(2.0, 6.1), servo_torque=(-2, 2), tilt=0.785,
        arm_angle=(1.05, 2.09), speed=(1.3, 1.3, 1.15), angular_rate=(8, 8, 2), arm_rate=1.57,
    )  # fmt: skip


def task(target: Motion = STILL, **changes: object) -> Handover:
    """Touch a target between x = 0 and x = 2.5 m."""
    values = {
        "name": "test", "start": {"z": 0.65, "arm": 1.57}, "end": {"x": 2.5, "z": 0.65, "arm": 1.57},
        "target": target, "contacts": {"position": Position(), "velocity": Velocity(), "heading": Heading()},
    }  # fmt: skip
    return Handover(**{**values, **changes})


def curved_plan(model: Model, bend: float = 0.0, n: int = 40) -> Plan:
    """A smooth flight from x = 0 to 2.5 m that bends by `bend` m in y and swings the arm."""
    s = np.linspace(0.0, 1.0, n + 1)
    c, u = model.configuration, model.inputs
    q = np.zeros((n + 1, 7))
    q[:, 0], q[:, 1] = 2.5 * s**2 * (3 - 2 * s), bend * np.sin(np.pi * s) ** 2
    q[:, 2], q[:, 6] = 0.65, np.pi / 2 + 0.4 * np.sin(2 * np.pi * s)
    time = 2.7 * s
    inputs = np.tile(model.hover(), (n, 1)) + 0.5 * np.sin(9 * s[:-1, None] + np.arange(5))
    progress = np.zeros(n + 1)
    progress[[17, 18]] = 1.0
    return Plan(
        time, q, np.gradient(q, time, axis=0), inputs, progress, "hold", c.names, c.units, u.names, u.units
    )


def dense(plan: Plan) -> Replay:
    """The plan itself, interpolated: stands for a replay where only shapes matter."""
    time = np.unique(np.concatenate([np.linspace(0, plan.travel_time, 301), plan.time]))
    q, v = (
        np.stack([np.interp(time, plan.time, column) for column in values.T], axis=-1)
        for values in (plan.configuration, plan.velocity)
    )
    return Replay(time, q, v, np.searchsorted(time, plan.time), (), None)


def compose(
    plan: Plan, scenario: Handover, model: Model, flight: Replay | None, title: str, verdict: str
) -> Figure:
    """The page as a figure that has been laid out."""
    with mpl.rc_context(RC):
        figure = picture.compose(
            picture.page(plan, scenario, model, flight, title, verdict), flight is not None
        )
        FigureCanvasAgg(figure)
        figure.draw_without_rendering()  # places and extents; nobody looks at its pixels
    return figure


def test_png_has_the_promised_size(tmp_path: Path) -> None:
    model, path = vehicle(), tmp_path / "new" / "plan.png"
    plan = curved_plan(model)
    picture.draw(path, plan, task(), model, dense(plan), "Title", "certified")
    with Image.open(path) as image:
        assert image.format == "PNG" and image.width == 2100 and 900 < image.height < 2000
        assert len(image.convert("RGB").getcolors(10**7)) > 500
    assert [p.name for p in path.parent.iterdir()] == ["plan.png"]


def test_plot_of_distance_matches_the_symbolic_model() -> None:
    model, scenario = vehicle(), task(ROUND)
    plan = curved_plan(model, 0.3)
    panel = contact_panels(plan, scenario, model, None)[0]
    q, t = ca.SX.sym("q", 7), plan.time
    tool = ca.Function("tool", [q], [model.tool(q)])
    target = np.stack([1.1 + 0.4 * np.sin(0.3 * t), 0.4 * np.cos(0.3 * t), np.full_like(t, 0.4)], axis=-1)
    distance = [
        np.linalg.norm(np.asarray(tool(row)).ravel() - p)
        for row, p in zip(plan.configuration, target, strict=True)
    ]
    dots = panel.curves[0].dots
    assert dots is not None and np.allclose(dots[1], distance, atol=1e-12)
    assert panel.curves[0].upper == 0.02 and panel.unit == "m" and "distance" in panel.title.lower()
    assert panel.note == f"in contact {max(distance[17:19]):.3g}"


def test_every_limited_quantity_has_its_own_limits() -> None:
    model, scenario = vehicle(), task(workspace={"z": (0.0, 1.5)})
    curves = {
        (c.label, p.unit): c
        for p in limit_panels(curved_plan(model), scenario, model, None)
        for c in p.curves
    }
    expected = {
        (name, unit): (low, high)
        for of in (model.velocity, scenario.limits(model), model.inputs)
        for name, unit, low, high in zip(of.names, of.units, of.lower, of.upper, strict=True)
        if np.isfinite(low) or np.isfinite(high)
    }
    assert {key: (c.lower, c.upper) for key, c in curves.items()} == expected
    assert ("z", "m") in curves and ("x", "m") not in curves


def test_panels_group_one_unit_of_similar_size() -> None:
    model = vehicle()
    panels = limit_panels(curved_plan(model), task(), model, None)
    groups = [tuple(c.label for c in p.curves) for p in panels]
    assert groups == [
        ("x", "y", "z"), ("roll", "pitch"), ("yaw", "arm"), ("roll", "pitch"), ("arm",),
        ("motor_1", "motor_2", "motor_3", "motor_4"), ("servo",),
    ]  # fmt: skip


def test_held_inputs_are_drawn_as_steps() -> None:
    model = vehicle()
    plan = curved_plan(model)
    servo = limit_panels(plan, task(), model, None)[-1].curves[0].line
    inside = np.random.default_rng(1).uniform(0.01, 2.69, 200)
    right = np.searchsorted(servo[0], inside)
    assert np.array_equal(servo[1][right], plan.input_at(inside)[:, 4])
    assert np.array_equal(servo[1][right - 1], servo[1][right])
    linear = replace(plan, inputs=np.vstack([plan.inputs, plan.inputs[-1:]]), interpolation="linear")
    times, values = limit_panels(linear, task(), model, None)[-1].curves[0].line
    assert np.allclose(values, np.interp(times, linear.time, linear.inputs[:, 4]), atol=1e-12)


@pytest.mark.parametrize(
    ("contact", "windows"),
    [([], []), ([0, 1], [(0, 1)]), ([3], [(3, 3)]), ([4, 5, 9, 40], [(4, 5), (9, 9), (40, 40)])],
)
def test_contact_windows(contact: list[int], windows: list[tuple[int, int]]) -> None:
    plan = curved_plan(vehicle())
    progress = np.full(41, 1e-8)
    progress[contact] = 0.4
    assert contact_windows(replace(plan, progress=progress)) == windows


def test_contact_is_drawn_where_the_certificate_sees_it() -> None:
    assert yaml.safe_load((ROOT / "conf/certificate/task.yaml").read_text())["contact_claim"] == CLAIM


def test_dashed_limits_and_shaded_contact_are_on_every_panel() -> None:
    model, scenario = vehicle(), task()
    plan = curved_plan(model)
    figure = compose(plan, scenario, model, dense(plan), "Title", "certified")
    panels = {a.get_title(loc="left"): a for a in figure.get_axes() if "[" in a.get_title(loc="left")}
    assert len(panels) == 3 + 7 - 1  # two panels share the title "Angular rate"
    for axes in panels.values():
        (window,) = (p for p in axes.patches if p.get_x() > 0)
        assert np.allclose([window.get_x(), window.get_x() + window.get_width()], plan.time[[17, 18]])
    dashed = {
        title: sorted(
            {
                float(line.get_ydata()[0])
                for line in axes.lines
                if line.is_dashed() and len(line.get_xdata()) == 2
            }
        )
        for title, axes in panels.items()
    }
    assert dashed["Relative speed  [m/s]"] == [0.01]
    assert dashed["Velocity  [m/s]"] == [-1.3, -1.15, 1.15, 1.3]
    assert dashed["Force  [N]"] == [2.0, 6.1]
    assert all(
        low < limit < high for t, a in panels.items() for limit in dashed[t] for low, high in [a.get_ylim()]
    )


def test_a_flat_motion_has_the_whole_width_and_a_bent_one_shares_it() -> None:
    """The side view of a straight flight; contacts stand in the grid below, and none is lost."""
    model = vehicle()
    widths, titles = [], []
    for plan in (curved_plan(model), curved_plan(model, 1.5)):
        figure = compose(plan, task(), model, dense(plan), "T", "certified")
        found = {a.get_title(loc="left"): a.get_window_extent() for a in figure.get_axes()}
        widths.append(found["Side view"].width / figure.bbox.width)
        titles.append({title for title in found if "[" in title})
    assert widths[0] > 0.9 and widths[1] < 0.66
    assert titles[0] == titles[1] and len(titles[0]) == 9


def test_the_floor_and_the_walls_are_drawn_where_they_are_near() -> None:
    """They do not widen the view: what is far is not seen."""
    model, plan = vehicle(), curved_plan(vehicle())
    seen = []
    for space in ({}, {"z": (0.45, 900.0), "x": (-0.1, 900.0)}):
        figure = compose(plan, task(workspace=space), model, None, "T", "certified")
        axes = next(a for a in figure.get_axes() if a.get_title(loc="left") == "Side view")
        dashed = [line for line in axes.get_children() if isinstance(line, Line2D) and line.is_dashed()]
        places = {
            (round(float(np.ptp(y)), 3), round(float(y[0]), 3), round(float(x[0]), 3))
            for x, y in (one.get_data() for one in dashed)
        }
        seen.append((axes.get_xlim(), axes.get_ylim(), places))
    assert seen[0][:2] == seen[1][:2]
    levels = [{y for wide, y, _ in places if wide == 0.0} for *_, places in seen]
    walls = [{x for wide, _, x in places if wide > 0.0} for *_, places in seen]
    assert 0.45 in levels[1] and 0.45 not in levels[0] and -0.1 in walls[1] and -0.1 not in walls[0]


def test_top_view_only_where_something_moves_sideways() -> None:
    model = vehicle()
    straight, bent = curved_plan(model), curved_plan(model, 0.3)
    assert not scene(straight, task(), model, None).sideways
    assert scene(bent, task(), model, None).sideways
    assert scene(straight, task(ROUND), model, None).sideways
    titles = [
        a.get_title(loc="left") for a in compose(bent, task(), model, None, "T", "certified").get_axes()
    ]
    assert {"Side view", "Top view"} <= set(titles)


@pytest.mark.parametrize("target", [STILL, ROUND])
@pytest.mark.parametrize(
    ("title", "verdict"),
    [
        ("Short", "certified"),
        ("A long title of a run " * 5, "NOT certified: " + "the relative speed is too large " * 9),
    ],
)
def test_no_text_overlaps_another_or_leaves_the_page(target: Motion, title: str, verdict: str) -> None:
    model = vehicle()
    plan = curved_plan(model, 0.0 if target is STILL else 0.4)
    figure = compose(plan, task(target), model, dense(plan), title, verdict)
    renderer = FigureCanvasAgg(figure).get_renderer()
    boxes = [(text.get_text(), text.get_window_extent(renderer)) for text in _drawn_texts(figure)]
    assert len(boxes) > 60
    for text, b in boxes:
        assert b.x0 >= 0 and b.y0 >= 0 and b.x1 <= figure.bbox.x1 and b.y1 <= figure.bbox.y1, text
    for (text_a, a), (text_b, b) in combinations(boxes, 2):
        apart = a.x1 <= b.x0 + 1 or b.x1 <= a.x0 + 1 or a.y1 <= b.y0 + 1 or b.y1 <= a.y0 + 1
        assert apart, f"{text_a!r} overlaps {text_b!r}"


def _drawn_texts(figure: Figure) -> list[Text]:
    """All texts, without the labels of ticks outside the limits, which exist but are not drawn."""
    hidden = []
    for axis in (axis for axes in figure.get_axes() for axis in (axes.xaxis, axes.yaxis)):
        low, high = sorted(axis.get_view_interval())
        for tick in [*axis.get_major_ticks(), *axis.get_minor_ticks()]:
            if not (axis.axes.axison and low <= tick.get_loc() <= high):
                hidden += [tick.label1, tick.label2]
    texts = (text for text in figure.findobj(Text) if text.get_visible() and text.get_text().strip())
    return [text for text in texts if not any(text is other for other in hidden)]


@pytest.mark.parametrize(
    "case",
    ["no replay", "broken replay", "no contact", "no contacts", "long contact", "few nodes", "straight up"],
)
def test_odd_plans_are_drawn_too(case: str, tmp_path: Path) -> None:
    model, scenario = vehicle(), task(ROUND)
    plan = (
        curved_plan(model, n=4 if case == "few nodes" else 40) if case != "few nodes" else _few_nodes(model)
    )
    flight: Replay | None = dense(plan)
    if case == "no replay":
        flight = None
    if case == "broken replay" and flight is not None:
        flight = replace(flight, configuration=np.full_like(flight.configuration, np.nan))
    if case == "no contact":
        plan = replace(plan, progress=np.zeros_like(plan.progress))
    if case == "long contact":
        plan = replace(plan, progress=np.full_like(plan.progress, 0.05))
    if case == "straight up":
        plan = replace(plan, configuration=plan.configuration[:, [2, 1, 0, 3, 4, 5, 6]])
    if case == "no contacts":
        scenario = task(ROUND, contacts={})
    picture.draw(tmp_path / "p.png", plan, scenario, model, flight, "T", "NOT certified: x")
    with Image.open(tmp_path / "p.png") as image:
        assert image.width == 2100 and 900 < image.height < 3600


def _few_nodes(model: Model) -> Plan:
    plan = curved_plan(model)
    keep = slice(None, None, 10)
    return replace(
        plan, time=plan.time[keep], configuration=plan.configuration[keep], velocity=plan.velocity[keep],
        inputs=plan.inputs[keep][:4], progress=np.array([0, 0, 1.0, 0, 0]),
    )  # fmt: skip


def test_runaway_replay_does_not_hide_the_plan() -> None:
    model = vehicle()
    plan = curved_plan(model)
    flight = dense(plan)
    far = replace(flight, configuration=flight.configuration * 100, velocity=flight.velocity * 100)
    figure = compose(plan, task(), model, far, "T", "NOT certified: x")
    axes = {a.get_title(loc="left"): a for a in figure.get_axes()}
    low, high = axes["Velocity  [m/s]"].get_ylim()
    assert high - low < 2 * 2.6
    assert np.ptp(axes["Side view"].get_xlim()) < 4


def test_real_flight_goes_through_the_same_picture(tmp_path: Path) -> None:
    model = vehicle()
    plan = curved_plan(model, n=20)
    picture.draw(
        tmp_path / "p.png",
        plan,
        task(),
        model,
        replay(plan, model.plant(), samples=2),
        "T",
        "NOT certified: x",
    )
    assert (tmp_path / "p.png").exists()


@final
class Slider(LagrangianModel):
    """A mass on a rail: one coordinate, one input, no arm, no height."""

    name = "slider"
    configuration: Coordinates = box(("x",), ("m",), np.array([-np.inf]), np.array([np.inf]))  # type: ignore[assignment]
    velocity: Coordinates = box(("x",), ("m/s",), np.array([-1.0]), np.array([2.0]))  # type: ignore[assignment]
    inputs: Coordinates = box(("push",), ("kN",), np.array([0.0]), np.array([np.inf]))  # type: ignore[assignment]

    def lagrangian(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """Unit mass."""
        return v[0] ** 2 / 2

    def force(self, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        """The push."""
        return u

    def tool(self, q: ca.SX) -> ca.SX:
        """The mass."""
        return ca.vertcat(q, 0, 0)

    def nose(self, q: ca.SX) -> ca.SX:
        """Along the rail."""
        return ca.SX([1, 0, 0])

    def hover(self) -> Array:
        """No push."""
        return np.zeros(1)

    def plant(self) -> Plant:
        """The same in numbers."""
        return SliderPlant()


@final
class SliderPlant(Plant):
    """Numbers of `Slider`."""

    def acceleration(self, q: Array, v: Array, u: Array) -> Array:
        """Unit mass."""
        return u

    def tool(self, q: Array, v: Array) -> tuple[Array, Array]:
        """The mass."""
        return q @ np.eye(1, 3), v @ np.eye(1, 3)

    def nose(self, q: Array) -> Array:
        """Along the rail."""
        return np.broadcast_to([1.0, 0.0, 0.0], (*q.shape[:-1], 3))

    def skeleton(self, q: Array) -> dict[str, Array]:
        """A short line."""
        return {"body": np.array([[q[0] - 0.1, 0, 0], [q[0] + 0.1, 0, 0]])}


def test_any_model_can_be_drawn(tmp_path: Path) -> None:
    model, time = Slider(), np.linspace(0, 1, 11)
    plan = Plan(time, time[:, None], np.ones((11, 1)), np.zeros((10, 1)), (time > 0.9) * 1.0, "hold",
                ("x",), ("m",), ("push",), ("kN",))  # fmt: skip
    scenario = Handover(
        name="s", start={}, end={"x": 1}, target=Fixed((1, 0, 0)), contacts={"touch": Position()}
    )
    assert [p.unit for p in limit_panels(plan, scenario, model, None)] == ["m/s", "kN"]
    picture.draw(tmp_path / "p.png", plan, scenario, model, None, "T", "certified")
    assert (tmp_path / "p.png").stat().st_size > 10_000


def test_a_figure_looks_the_same_whatever_the_settings_of_who_shows_it(tmp_path: Path) -> None:
    model, plan = vehicle(), curved_plan(vehicle())
    shown = (plan, task(), model, dense(plan), "T", "certified")
    picture.draw(tmp_path / "p.png", *shown)
    with Image.open(tmp_path / "p.png") as file:
        stored = np.asarray(file.convert("RGB"))
    figure, before = picture.figure(*shown), mpl.rcParams.copy()
    with mpl.rc_context(
        {
            "font.size": 20,
            "xtick.labelsize": 20,
            "axes.grid": False,
            "text.color": "red",
            "figure.facecolor": "black",
        }
    ):
        canvas = FigureCanvasAgg(figure)
        figure.set_dpi(150)
        canvas.draw()
        assert np.array_equal(np.asarray(canvas.buffer_rgba())[..., :3], stored)
    assert mpl.rcParams.copy() == before


def test_folder_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    model, path = vehicle(), tmp_path / "file" / "p.png"
    path.parent.write_text("in the way")
    with pytest.raises(BadInput, match="output"):
        picture.draw(path, curved_plan(model), task(), model, None, "T", "certified")


def test_no_global_plot_state_and_a_face_that_loads_nothing() -> None:
    code = (
        "import sys, benchbench\n"
        "print({'numpy', 'casadi', 'hydra', 'pandas', 'matplotlib', 'pydantic', 'rich'} & set(sys.modules))\n"
        "import matplotlib as m; before = m.rcParams.copy(); import benchbench.report.picture\n"
        "print('matplotlib.pyplot' in sys.modules, before == m.rcParams.copy())"
    )
    environment = {"PYTHONPATH": str(ROOT), "PATH": ""}
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment
    )
    assert done.stdout.split() == ["set()", "False", "True"]


@pytest.mark.parametrize(
    ("verdict", "color"),
    [("certified", GOOD), ("certified; closest to a limit: z", GOOD), ("NOT certified: z", BAD)],
)
def test_only_a_plan_that_is_not_certified_is_red(verdict: str, color: str) -> None:
    plan, model = curved_plan(vehicle()), vehicle()
    with mpl.rc_context(RC):
        figure = picture.compose(picture.page(plan, task(), model, None, "Title", verdict), False)
    (said,) = (text for text in figure.findobj(Text) if text.get_text() == verdict)
    box = said.get_bbox_patch()
    assert box is not None and mpl.colors.to_hex(box.get_facecolor()).upper() == color
