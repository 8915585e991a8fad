"""A kind of scenario is a folder of its own: examples/reach is planned, certified, drawn and recorded by an unchanged core."""

from __future__ import annotations

import ast
import json
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import composing
import numpy as np
import pytest
from packages import install, install_example
from PIL import Image
from program import Done, told

from benchbench.certificate.certify import certify
from benchbench.cli import report_content
from benchbench.conformance.checks import scenarios as checks
from benchbench.ground import registry
from benchbench.ground.errors import BadInput, IncompatibleCase
from benchbench.ocp.kinds import kind_of, kinds
from benchbench.ocp.scenario import Scenario, at_rest
from benchbench.planning import posing
from benchbench.planning.case import Case
from benchbench.report.style import TARGET
from benchbench.storage.collect import collect
from benchbench.storage.playback import read_mcap

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "examples" / "reach"
KINDS = {"Scenario", "Handover", "Race", "Reach"}
FLIGHT = ("+scenario=across", "solver=ipopt", "scenario.intervals=60", "dynamics=collocation")


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """Folders with the package and with what was registered for it."""
    return [str(install_example(FOLDER, tmp_path_factory.mktemp("site"))), str(FOLDER)]


@pytest.fixture(autouse=True, scope="module")
def _there(path: list[str]) -> Iterator[None]:
    """As if it were installed."""
    sys.path[:0] = path
    yield
    for entry in path:
        sys.path.remove(entry)


@pytest.fixture(scope="module")
def flown(tmp_path_factory: pytest.TempPathFactory) -> SimpleNamespace:
    """One run by the program, as a user starts it."""
    folder = tmp_path_factory.mktemp("across")
    done: Done = told(folder, *FLIGHT, "compile=never", "output=results")
    assert done.returncode == 0, done.stdout + done.stderr
    (run,) = (folder / "results" / "runs").glob("*/*")
    case = composing.case_of(*FLIGHT, "compile=never")
    return SimpleNamespace(
        said=done.stdout, run=run, record=json.loads((run / "record.json").read_text()), case=case,
        plan=read_mcap(run / "plan.mcap").plan, results=folder / "results",
    )  # fmt: skip


def test_it_is_planned_and_certified(flown: SimpleNamespace) -> None:
    """It stops on the near side of the ball: every way on would only take time."""
    record, scenario = flown.record, flown.case.scenario
    assert record["certified"] is True and "certified" in flown.said
    assert 0 < record["lower_bound_s"] < record["travel_time_s"]
    place = flown.plan.configuration[-1, :3]
    middle = np.array([scenario.end[axis] for axis in "xyz"])
    assert np.linalg.norm(place - middle) == pytest.approx(scenario.reach, abs=1e-5)
    assert place[0] < middle[0] - 0.9 * scenario.reach
    np.testing.assert_allclose(flown.plan.velocity[-1], 0.0, atol=1e-6)


def test_the_lower_bound_is_that_of_full_speed(flown: SimpleNamespace) -> None:
    """X is the axis with the longest way, 3 m less the radius."""
    fastest = flown.case.model.velocity.upper[0]
    assert flown.record["lower_bound_s"] == pytest.approx((3.0 - 0.5) / fastest)


def test_a_smaller_ball_is_asked_for_by_its_own_checks(flown: SimpleNamespace) -> None:
    case = flown.case
    smaller = case.scenario.model_copy(update={"reach": 0.4})
    verdict = certify(flown.plan, smaller, case.model, case.limits)
    assert {check.name for check in verdict.checks if not check.ok} == {"planned_reach", "reach"}
    assert any("0.5 m" in reason and "allowed 0.4" in reason for reason in verdict.reasons)


def test_it_is_recorded_without_what_others_have(flown: SimpleNamespace) -> None:
    record = flown.record
    assert record["scenario"] == "across" and record["intervals"] == 60
    for column in ("kappa_init", "contact_steps", "stops", "gates", "gates_passed"):
        assert record[column] is None
    assert not flown.plan.progress.any()


def test_it_is_drawn(flown: SimpleNamespace) -> None:
    """The ball is the only thing on the page in the colour of targets."""
    pixels = np.asarray(Image.open(flown.run / "plan.png").convert("RGB"), int)
    olive = np.array([int(TARGET[i : i + 2], 16) for i in (1, 3, 5)])
    rows, columns = np.nonzero(np.abs(pixels - olive).max(axis=2) < 8)
    assert len(rows) > 500
    assert columns.max() < 0.7 * pixels.shape[1]  # in the views, not in the panels or the header
    assert rows.min() > 0.05 * pixels.shape[0]


def test_it_is_shown_in_a_report(flown: SimpleNamespace) -> None:
    shown = report_content.content(collect([flown.results]), [flown.results], None, 1)
    assert shown.missing == []
    (plan,) = shown.plans
    assert "ball" in {trace.name for trace in plan.view.data}
    assert any("Distance to the end" in note.text for note in plan.limits.layout.annotations)


@pytest.mark.parametrize("check", checks.CHECKS, ids=lambda check: check.__name__)
def test_it_passes_the_conformance_suite(check: Callable[[Case], None], flown: SimpleNamespace) -> None:
    check(flown.case)


def test_the_task_tells_balls_apart_but_not_how_it_is_planned(flown: SimpleNamespace) -> None:
    def hash_of(*more: str) -> str | None:
        return composing.case_of(*FLIGHT, "compile=never", *more).task_hash

    assert flown.case.task_hash is not None
    assert hash_of("scenario.reach=0.4") != flown.case.task_hash
    same = ("scenario.travel_time_guess=2", "+scenario.kind=reach", "solver=sqpmethod")
    assert hash_of(*same) == flown.case.task_hash


# Which kind a configuration means


def test_kinds_are_told_by_their_mark_or_by_name() -> None:
    reach = kinds()["reach"]
    assert list(kinds())[:2] == ["handover", "race"] and issubclass(reach, Scenario)
    assert kind_of({"reach": 1.0}) is kind_of({"kind": "reach"}) is reach
    assert kind_of({"track": []}) is kinds()["race"]
    assert kind_of({}) is kind_of({"target": None}) is kinds()["handover"]


@pytest.mark.parametrize(
    ("overrides", "said"),
    [
        (("+scenario=static", "+scenario.kind=orbit"), "scenario.kind: 'orbit' is not installed; allowed: handover, race, reach"),
        (("+scenario=static", "+scenario.kind=race"), "scenario.target: means nothing in a race"),
        (("+scenario=across", "scenario.reach=0"), "scenario.reach: 0 was given"),
        (("+scenario=across", "+scenario.kappa_init=2"), "scenario.kappa_init: does not exist"),
        (("+scenario=across", "scenario.travel_time=[0.1,1.5]"), "scenario.travel_time: 1.5 s are too short"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_told_by_its_field(overrides: tuple[str, ...], said: str, tmp_path: Path) -> None:
    done = told(tmp_path, *overrides, "compile=never")
    assert done.returncode == 2
    assert said in " ".join(done.stderr.split())


def test_a_kind_that_cannot_be_loaded_says_why(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(install(tmp_path, "lost", {"benchbench.scenarios": {"lost": "nowhere:Lost"}}))
    with pytest.raises(BadInput, match=r"scenario\.kind: 'lost' cannot be loaded: .*nowhere"):
        kind_of({"kind": "lost"})
    assert "lost" not in kinds()


def test_it_is_registered_like_a_plugin() -> None:
    (plugin,) = registry.installed("scenarios")
    assert (plugin.name, plugin.distribution, plugin.error) == ("reach", "benchbench-reach", "")
    assert plugin.summary.startswith("Fly from `start` in least time")


# What the conformance suite finds


def spoilt(case: Case, **methods: Any) -> Case:
    """The same case with a kind of scenario whose answers are wrong."""
    kind = type(case.scenario)
    other = type("Spoilt", (kind,), {"__module__": __name__, **methods})
    return case.__class__(**{**vars(case), "scenario": other(**dict(case.scenario))})


@pytest.mark.parametrize(
    ("check", "methods", "said"),
    [
        (checks.check_path, {"flown": lambda self, model, nodes: np.linspace(1.0, 0.0, nodes)}, "does not grow"),
        (checks.check_path, {"flown": lambda self, model, nodes: np.arange(nodes) * 1.0}, "length of the path"),
        (checks.check_grid, {"on_grid": lambda self, intervals: self}, "another number of intervals"),
        (checks.check_ends, {"end_point": lambda self, model: self.start_point(model) + 9.0}, "outside the limits"),
        (
            checks.check_ends,
            {"ends": lambda self, model: at_rest(self.start_point(model), self.limits(model), model)},
            "no flight may end",
        ),
        (checks.check_forms, {"grid_intervals": property(lambda self: 7)}, "another number of intervals"),
    ],
)  # fmt: skip
def test_wrong_answers_are_found(
    check: Callable[[Case], None], methods: dict[str, Any], said: str, flown: SimpleNamespace
) -> None:
    with pytest.raises(AssertionError, match=said):
        check(spoilt(flown.case, **methods))


def test_a_kind_without_a_certificate_is_never_certified(flown: SimpleNamespace) -> None:
    """It may be posed like a flight without stops, but what it is asked nobody may guess."""
    reach = type(flown.case.scenario)
    own = ("on_grid", "itinerary", "start_point", "end_point", "ends", "flown", "grid_intervals")
    fields = {"__annotations__": {"intervals": int}, "__module__": __name__}
    bare = type("Bare", (Scenario,), {**fields, **{name: getattr(reach, name) for name in own}})
    said = {k: v for k, v in dict(flown.case.scenario).items() if k != "reach"}
    case = flown.case.__class__(**{**vars(flown.case), "scenario": bare(**said)})
    checks.check_forms(case)
    checks.check_picture(case)
    with pytest.raises(IncompatibleCase, match="nothing says how a Bare is certified"):
        certify(posing.line(case), case.scenario, case.model, case.limits)


def test_a_scenario_alone_is_no_task() -> None:
    with pytest.raises(TypeError, match="abstract"):
        Scenario(name="nothing", start={}, end={})


# The rule


def test_nothing_asks_whether_a_scenario_is_a_race() -> None:
    """Rooms and tests ask by functions that dispatch on the kind, so that kinds of others are not left out."""
    found = []
    for part in ("benchbench", "plugins", "tests", "examples"):
        for file in (ROOT / part).rglob("*.py"):
            text = file.read_text()
            tree = (
                ast.parse(text)
                if "isinstance(" in text and any(kind in text for kind in KINDS)
                else ast.Module([], [])
            )
            for node in ast.walk(tree):
                if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "isinstance":
                    named = {getattr(n, "id", getattr(n, "attr", "")) for n in ast.walk(node.args[1])}
                    found += [f"{file.relative_to(ROOT)}:{node.lineno}"] if named & KINDS else []
    assert found == []
