"""A check of one's own: one function and one line of YAML, and it is in the verdict, the record and the summary."""

from __future__ import annotations

import io
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any, final

import numpy as np
import pytest
from packages import install
from rich.console import Console
from test_certificate import LIMITS, SOLVED, only_reason
from test_handover_certificate import MODEL, hover, task

import benchbench as bb
from benchbench.certificate.certificate import Measures
from benchbench.certificate.certify import certify
from benchbench.certificate.checks.nodes import planned_end, planned_start
from benchbench.certificate.checks.replay import replay_end
from benchbench.certificate.evidence import Given
from benchbench.certificate.examination import Examination, examine
from benchbench.certificate.limits import Limits
from benchbench.certificate.measured import measured
from benchbench.certificate.named import named
from benchbench.certificate.numbers import flown
from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput
from benchbench.ocp.model import Model
from benchbench.ocp.scenario import Ends, Scenario, at_rest, point, straight
from benchbench.ocp.stop import Itinerary
from benchbench.run import config, pipeline, summary, trust
from benchbench.storage.flight_csv import to_csv
from benchbench.storage.multirotor import trajectory_of

FLIGHT = ("+scenario=race", "scenario.gates=1", "scenario.nodes_per_gate=20")
YAML = "defaults: [task, _self_]\nchecks: {test_checks.acceleration: 0.1}\n"


def acceleration(evidence: bb.Evidence, limit: float) -> bb.Check:
    """The largest change of a planned velocity in x, per second."""
    change = np.abs(np.diff(evidence.plan.velocity[:, 0]) / np.diff(evidence.plan.time))
    value, (k,) = bb.worst(change)
    return bb.at_most(
        "acceleration", "acceleration", value, limit, "m/s^2", f" at node {k}", advice="fly slower"
    )


def present(evidence: bb.Evidence) -> Iterator[bb.Check]:
    """All the evidence is there, of every state component."""
    for values in (evidence.missed.configuration, evidence.missed.velocity, evidence.flight.velocity):
        yield bb.Check("present", float(values.size), 0.0, "1", bool(np.isfinite(values).all()))


def posed(evidence: bb.Evidence) -> bb.Check:
    """What is left of the problem that the plan came from."""
    assert evidence.residuals is not None
    return bb.Check("posed", evidence.residuals.max_violation, 1.0, "1", True)


def unknown(evidence: bb.Evidence) -> bb.Check:
    """It says that what is not a number is right."""
    return bb.Check("unknown", np.nan, 1.0, "m", True)


def opinion(evidence: bb.Evidence) -> bool:
    """It gives no check."""
    return True


def test_one_function_and_one_line_of_yaml(tmp_path: Path) -> None:
    """A plan that is certified as it is, read from a file and judged by one check more."""
    done = pipeline.run(config.compose(*FLIGHT))
    assert done.certificate.certified
    (tmp_path / "plan.csv").write_text(to_csv(trajectory_of(done.result.plan)))
    (tmp_path / "certificate").mkdir()
    (tmp_path / "certificate" / "mine.yaml").write_text(YAML)
    mine = (f"hydra.searchpath=[file://{tmp_path}]", "certificate=mine")
    foreign = ("strategy=foreign", f"strategy.file={tmp_path}/plan.csv")
    judged = pipeline.run(config.compose(*FLIGHT, *mine, *foreign))
    (reason,) = judged.certificate.reasons
    assert reason.startswith("acceleration reaches ") and reason.endswith("allowed 0.1 m/s^2")
    assert judged.certificate.advice == "fly slower"
    assert judged.record["certified"] is False and judged.record["reasons"] == [reason]
    said = io.StringIO()
    summary.show(judged.record, {}, Console(file=said, width=200))
    assert f"- {reason}" in said.getvalue()
    weaker = config.compose(*FLIGHT, *mine, "certificate.checks={test_checks.acceleration: 100}")
    assert certify(done.result.plan, weaker.scenario, weaker.model, weaker.limits).certified
    tasks = (config.compose(*FLIGHT), config.compose(*FLIGHT, *mine), weaker)
    assert len({case.task_hash for case in tasks}) == 3


def limits(**checks: object) -> Limits:
    return Limits(**(LIMITS.model_dump() | {"checks": {f"test_checks.{k}": v for k, v in checks.items()}}))


def test_further_checks_are_asked_of_all_the_evidence() -> None:
    plan = hover(4, 5)
    found = certify(plan, task(), MODEL, limits(present=True, acceleration=100.0, unknown=None))
    assert found.certified
    assert [check.name for check in found.checks][-4:] == ["present", "present", "present", "acceleration"]
    later = certify(plan, task(), MODEL, limits(unknown=None, posed=True), SOLVED)
    assert later.certified and later.checks[-1] == bb.Check("posed", 1e-9, 1.0, "1", True)


def test_only_long_flights_are_begun_anew() -> None:
    told = LIMITS.model_copy(update={"restart_seconds": 1.5, "restart_beyond": 4.0})
    assert [told.restarts(time) for time in (3.0, 4.0, 4.001, 60.0)] == [None, None, 1.5, 1.5]


def test_what_is_not_a_number_passes_no_check() -> None:
    plan = hover(4, 5)
    assert only_reason(certify(plan, task(), MODEL, limits(unknown=True))) == "unknown is not a number"
    assert bb.Check("x", np.nan, 1.0, "m", True).ok is False
    assert not bb.at_most("x", "x", np.nan, 1.0, "m").ok and not bb.at_least("x", "x", np.nan, 1.0, "m").ok
    assert not bb.at_most("x", "x", 1.0, np.nan, "m").ok and not bb.at_least("x", "x", 1.0, np.nan, "m").ok


@pytest.mark.parametrize(
    ("name", "limit", "said"),
    [
        ("nothing", 1.0, "checks.nothing: there is no such check; allowed: package.module.function"),
        ("pytest", 1.0, "there is no such check"),  # a name of another group
        ("no_module.f", 1.0, "cannot be loaded: ModuleNotFoundError"),
        ("test_checks.nothing", 1.0, "there is no such check"),
        ("test_checks.YAML", 1.0, "is no function"),
        (
            "test_checks.acceleration",
            True,
            r"checks\.test_checks\.acceleration: needs a limit; allowed: a number",
        ),
        ("test_checks.present", 1.0, r"checks\.test_checks\.present: takes no limit; allowed: true"),
    ],
)
def test_a_check_that_cannot_be_asked_is_bad_input(name: str, limit: object, said: str) -> None:
    with pytest.raises(BadInput, match=said):
        Limits(**(LIMITS.model_dump() | {"checks": {name: limit}}))


def test_a_function_of_a_module_in_a_package_is_found() -> None:
    assert named("os.path.samefile") is os.path.samefile
    assert Limits(**(LIMITS.model_dump() | {"checks": {"os.path.samefile": 1.0}})).checks == {
        "os.path.samefile": 1.0
    }


def test_a_stored_configuration_names_no_function_by_its_path() -> None:
    stored: dict[str, Any] = {
        "certificate": {"_target_": "benchbench.certificate.limits.Limits", "checks": {"smooth": 1.0}}
    }
    trust.check(stored, "configuration")
    stored["certificate"]["checks"] = {"test_checks.acceleration": 1.0}
    with pytest.raises(BadInput, match=r"checks\.test_checks\.acceleration: stands in a stored"):
        trust.check(stored, "configuration")


def test_what_gives_no_check_is_bad_input() -> None:
    plan = hover(4, 5)
    with pytest.raises(BadInput, match=r"opinion: gives a bool; allowed: a benchbench\.Check, or several"):
        certify(plan, task(), MODEL, limits(opinion=True))


@final
class Hop(Scenario):
    """A kind of scenario of a stranger's: from start to end, and as high as `top` m on the way."""

    top: float

    @property
    def grid_intervals(self) -> int:
        return 20

    def on_grid(self, intervals: int) -> None:
        return None

    @property
    def itinerary(self) -> Itinerary:
        return Itinerary(())

    def start_point(self, model: Model) -> Array:
        return point(self.start, model, "scenario.start")

    def end_point(self, model: Model) -> Array:
        return point(self.end, model, "scenario.end")

    def ends(self, model: Model) -> Ends:
        return at_rest(self.end_point(model), self.limits(model), model)

    def flown(self, model: Model, nodes: int) -> Array:
        return straight(self.start_point(model), self.end_point(model), model, nodes)


def high_enough(evidence: bb.Evidence) -> Iterator[bb.Check]:
    assert isinstance(evidence.scenario, Hop)
    top = float(evidence.flight.configuration[:, 2].max())
    yield bb.at_least("high_enough", "the highest point", top, evidence.scenario.top, "m")


def test_a_kind_of_scenario_registers_its_evidence_and_checks() -> None:
    plan = hover(4, 5)
    ends = {
        side: dict(zip(MODEL.configuration.names, plan.configuration[k], strict=True))
        for side, k in (("start", 0), ("end", -1))
    }
    with pytest.raises(bb.IncompatibleCase, match="nothing says how a Hop is certified"):
        certify(plan, Hop(name="hop", top=0.0, **ends), MODEL, LIMITS)

    @examine.register
    def _(scenario: Hop, given: Given) -> Examination:
        evidence = measured(scenario, given)
        return Examination(
            evidence, (planned_start, planned_end), (replay_end, high_enough), Measures(**flown(evidence))
        )

    top = float(plan.configuration[:, 2].max())
    found = certify(plan, Hop(name="hop", top=top - 0.01, **ends), MODEL, LIMITS)
    assert found.certified and found.record()["replay_defect_position_m"] < 1e-6
    assert [check.name for check in found.checks][-1] == "high_enough"
    low = certify(plan, Hop(name="hop", top=top + 1.0, **ends), MODEL, LIMITS)
    assert only_reason(low).startswith("the highest point is only ")
    moved = Hop(name="hop", top=0.0, **(ends | {"end": ends["end"] | {"x": 1.0}}))
    assert "distance from the end on the replay" in " ".join(certify(plan, moved, MODEL, LIMITS).reasons)


def test_installed_packages_give_their_checks_short_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    groups = {"benchbench.checks": {"smooth": "test_checks:acceleration"}}
    monkeypatch.syspath_prepend(install(tmp_path, "stranger", groups))
    told = Limits(**(LIMITS.model_dump() | {"checks": {"smooth": -1.0}}))
    reason = only_reason(certify(hover(4, 5), task(), MODEL, told))
    assert reason == "acceleration reaches 0 m/s^2 at node 0, allowed -1 m/s^2"
    with pytest.raises(BadInput, match=r"allowed: smooth, package\.module\.function"):
        Limits(**(LIMITS.model_dump() | {"checks": {"smoth": 0.1}}))
