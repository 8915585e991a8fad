"""Plans from elsewhere: the CSV format, and `benchbench certify` on good and spoiled plans of an independent simulator."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path

import composing
import numpy as np
import pytest
from program import Done, assert_refused, told
from simulator import GOOD, Flown, fly

from benchbench.certificate.certificate import Certificate
from benchbench.cli.commands.certify import run
from benchbench.ground.errors import BadInput
from benchbench.planning.case import Case
from benchbench.run import pipeline
from benchbench.storage.flight_csv import to_csv
from benchbench.storage.multirotor import trajectory_of
from benchbench.storage.recording import write_mcap

RACE = ("+scenario=race", "scenario.gates=1", "scenario.nodes_per_gate=20")
HANDOVER = ("+scenario=static", "strategy=phases", "scenario.intervals=30")


@cache
def own(*overrides: str) -> pipeline.Run:
    return pipeline.run(composing.case_of(*overrides))


@pytest.mark.parametrize("overrides", [RACE, HANDOVER])
def test_our_plan_comes_back_with_the_same_numbers(tmp_path: Path, overrides: tuple[str, ...]) -> None:
    """Quaternions, or Euler angles with an arm: exported, read and judged again."""
    done = own(*overrides)
    file = tmp_path / "plan.csv"
    file.write_text(to_csv(trajectory_of(done.result.plan)))
    again = pipeline.run(composing.case_of(*overrides[:2], "strategy=foreign", f"strategy.file={file}"))
    for name in ("time", "configuration", "velocity", "inputs", "progress"):
        np.testing.assert_allclose(
            getattr(again.result.plan, name), getattr(done.result.plan, name), atol=1e-9
        )
    assert again.certificate.certified == done.certificate.certified
    for name, value in vars(done.certificate.measures).items():
        if isinstance(value, float) and name not in (
            "max_violation",
            "max_complementarity",
            "max_product",
        ):  # of no problem of ours
            assert getattr(again.certificate.measures, name) == pytest.approx(value, rel=1e-4, abs=1e-7), name
    assert again.record["solver"] == again.record["strategy"] == "foreign"


def test_a_recorded_plan_of_another_vehicle_is_refused(tmp_path: Path) -> None:
    """The paper's two vehicles have the same coordinates: only the recording says whose plan it is."""
    from omegaconf import OmegaConf

    from benchbench.run import config

    done, file = own(*HANDOVER), tmp_path / "plan.mcap"
    assert isinstance(done.case, Case)
    text = OmegaConf.to_yaml(config.composed(*HANDOVER)[0])
    write_mcap(file, done.result.plan, None, done.case.scenario, done.case.model, {"config": text})
    asked = (HANDOVER[0], "strategy=foreign", f"strategy.file={file}")
    assert pipeline.run(composing.case_of(*asked)).certificate.certified == done.certificate.certified
    found = told(tmp_path, *asked, "vehicle=table2", "flights=1")
    first, second = found.stderr.splitlines()
    assert (found.returncode, first) == (2, "benchbench: bad input")
    assert second.startswith("  vehicle: 'table2' was asked for, but ") and "a plan of 'table1'" in second


def task(first: Sequence[float] = GOOD[1], second: Sequence[float] = GOOD[2], *more: str) -> tuple[str, ...]:
    lap = [[float(x) for x in gate] for gate in (first, second)]
    return (
        "+scenario=race", f"scenario.track={lap}".replace(" ", ""), "scenario.gates=2", "scenario.end={x:2,y:-1,z:1.2}", *more
    )  # fmt: skip


def judge(flown: Flown, folder: Path, *overrides: str) -> Certificate:
    file = folder / "flight.csv"
    file.write_text(flown.csv())
    case = composing.case_of(*(overrides or task()), "strategy=foreign", f"strategy.file={file}")
    return pipeline.run(case).certificate


def broken(certificate: Certificate) -> set[str]:
    return {check.name for check in certificate.checks if not check.ok}


good = cache(fly)


def test_a_flight_of_an_independent_simulator_is_certified(tmp_path: Path) -> None:
    found = judge(good(), tmp_path)
    assert found.certified, found.reasons
    assert found.measures.gates_passed == 2
    assert found.measures.replay_drift_position_m < 1e-6


def pulse(t: float) -> np.ndarray:
    """All motors twice as strong as they can be, for 4 ms between two rows."""
    return np.full(4, 10.0 if 1.902 < t < 1.906 else 0.0)


SPOILED: dict[str, tuple[Callable[[], Flown], set[str]]] = {
    "thrust over its limit in a row": (lambda: good().changed(slice(14, 18), 75, 6.0), {"planned_input"}),
    "thrust over its limit between rows": (lambda: fly(gust=pulse), {"defect_position", "segment"}),
    "velocity that is not that of the positions": (
        lambda: good().changed(8, slice(1, None), 0.15),
        {"defect_position"},
    ),
    "thrusts that the rest does not follow": (
        lambda: good().changed(14, slice(50, 55), 0.3),
        {"segment"},
    ),
    "teleport": (lambda: good().changed(1, slice(100, None), 0.5), {"defect_position", "segment"}),
    "starts elsewhere": (lambda: good().changed(2, slice(None), 0.2), {"planned_start"}),
    "body rate over its limit": (lambda: good().changed(13, 38, 0.5), {"planned_velocity"}),
    "stops before the end": (lambda: Flown(good().rows[:-30]), {"gate", "replay_end"}),
    "time runs faster": (
        lambda: good().changed(0, slice(None), -0.1 * good().rows[:, 0]),
        {"defect_position"},
    ),
}


@pytest.mark.parametrize("name", SPOILED)
def test_each_spoiled_flight_is_rejected_for_its_reason(name: str, tmp_path: Path) -> None:
    spoil, reasons = SPOILED[name]
    assert reasons <= broken(judge(spoil(), tmp_path))


def test_a_gate_missed_by_five_centimetres_and_gates_in_the_other_order(tmp_path: Path) -> None:
    at = good().rows[70]
    across = np.cross(at[8:11], [0, 0, 1.0])
    for far, holds in ((0.305, True), (0.35, False)):
        gate = at[1:4] + far * across / np.linalg.norm(across)
        found = judge(good(), tmp_path, *task(gate))
        assert broken(found) == (set() if holds else {"gate"})
        assert holds or "gate 1 is passed at 0.3" in found.reasons[0]
    swapped = judge(good(), tmp_path, *task(GOOD[2], GOOD[1]))
    assert broken(swapped) == {"gate"} and "gate 2" in swapped.reasons[0]


def certify(folder: Path, text: str, *arguments: str) -> Done:
    (folder / "my plan.csv").write_text(text)
    return told(folder, "certify", "my plan.csv", "--scenario", "race", *task()[1:], *arguments)


def test_the_command_certifies_records_and_draws(tmp_path: Path) -> None:
    done = certify(tmp_path, good().csv(), "--name", "my planner 2.0")
    assert (done.returncode, done.stderr) == (0, "")
    (path,) = tmp_path.rglob("record.json")
    record = json.loads(path.read_text())
    assert (record["solver"], record["strategy"], record["status"]) == (
        "my planner 2.0",
        "foreign",
        "certified",
    )
    assert record["dynamics"] is record["relaxation"] is record["guess"] is None
    assert {"plan.mcap", "plan.png", "config.yaml"} <= {file.name for file in path.parent.iterdir()}
    table = told(tmp_path, "table", "--columns", "solver,status,travel_time_s").stdout
    assert "my planner 2.0" in table and "4.2" in table


def test_the_command_rejects_and_refuses(tmp_path: Path) -> None:
    done = certify(tmp_path, good().changed(1, slice(100, None), 0.5).csv(), "picture=false")
    assert done.returncode == 1 and "NOT certified" in done.stdout and "position defect" in done.stdout
    assert_refused(
        certify(tmp_path, good().csv().replace("p_z", "height")), "my plan.csv", "has no column p_z"
    )
    for arguments, said in (
        (["none.csv", "--scenario", "race"], "none.csv: there is no such file"),
        ([], "plan: none was given"),
        ([__file__], "--scenario: none was chosen"),
        ([__file__, "--scenario", "race", "+scenario=race"], "--scenario: is chosen twice"),
        ([__file__, "--scenario", "race", "--interpolation", "cubic"], "invalid choice: 'cubic'"),
    ):
        with pytest.raises(BadInput, match=said):
            run(arguments)
    assert not list(tmp_path.glob("results/runs/*/*/plan.mcap"))[1:]
