"""Best known values: what may be compared with what, what is kept, what a run says of them."""

from __future__ import annotations

import gzip
import re
import shlex
import sys
from functools import cache
from pathlib import Path
from typing import Any

import composing
import pytest
import yaml
from program import assert_refused, records, told

from benchbench.cli.commands import best
from benchbench.ground.errors import BadInput
from benchbench.run import config, pipeline
from benchbench.run.suites import suite
from benchbench.storage.best_known import OF_SUITES, BestKnown, beats, net_time, packaged
from benchbench.storage.files import write_bytes, write_record
from benchbench.storage.schema import Record, make_record

HANDOVER = ("+scenario=circle", "strategy=phases")
RACE = ("+scenario=race", "scenario.gates=1")

SMALL = (
    "strategy=phases", "dynamics=collocation", "scenario.intervals=14", "scenario.rate_margin.arm=0.05",
    "scenario.contacts.velocity=null", "compile=never",
)  # fmt: skip
"""The smallest grid on which a plan is certified, for an easier task."""

SAME = [
    (HANDOVER, "scenario.rate_margin.arm=0.03"), (HANDOVER, "scenario.contact_margin.position=0"),
    (HANDOVER, "scenario.travel_time_guess=4"), (HANDOVER, "scenario.contact_guess=0.5"),
    (HANDOVER, "scenario.name=mine"), (HANDOVER, "vehicle.name=mine"), (HANDOVER, "strategy=relax"),
    (HANDOVER, "relaxation=kadrani"), (HANDOVER, "guess=line"), (HANDOVER, "seed=3"), (HANDOVER, "time_limit=9"),
    (HANDOVER, "certificate.stationarity=on"), (HANDOVER, "certificate.stationarity_seconds=3"),
    (HANDOVER, "scenario.contact_seconds=null"),
    (HANDOVER, "scenario.input_cost=0.003"), (HANDOVER, "scenario.travel_time=[0.1,30]"),
    (HANDOVER, "scenario.target._target_=benchbench_plugins.motions.circle.Circle"),
    (RACE, "scenario.gate_margin=0.1"), (RACE, "scenario.speed_guess=7"),
]  # fmt: skip
OTHER = [
    (HANDOVER, "scenario.intervals=101"), (HANDOVER, "scenario.kappa_init=3"), (HANDOVER, "dynamics=rk4"),
    (HANDOVER, "dynamics.inputs=nodal"), (HANDOVER, "scenario.target.radius_m=0.5"), (HANDOVER, "scenario.end.x=2.4"),
    (HANDOVER, "scenario.contact_seconds=0.1"), (HANDOVER, "scenario.contacts.heading=null"),
    (HANDOVER, "scenario.contacts.velocity.limit=0.02"), (HANDOVER, "+scenario/contact=floor"),
    (HANDOVER, "scenario.workspace.z=[0,2]"), (HANDOVER, "scenario.hover_ends=true"),
    (HANDOVER, "scenario.input_cost=0.001"), (HANDOVER, "vehicle.arm_length=0.1"),
    (HANDOVER, "vehicle.force_model=paper"), (HANDOVER, "certificate.rate_ratio=1.2"),
    (HANDOVER, "certificate.contact_allowance.position=0.01"), (RACE, "scenario.gates=2"),
    (RACE, "scenario.radius=0.5"), (RACE, "scenario.nodes_per_gate=20"), (RACE, "scenario.end_velocity=rest"),
    (RACE, "scenario.track=[[0,0,2]]"), (RACE, "vehicle.mass=1"),
]  # fmt: skip


def key(*overrides: str) -> str:
    found = composing.case_of(*overrides).task_hash
    assert found
    return found


@pytest.fixture(scope="module")
def keys() -> dict[tuple[str, ...], str]:
    return {base: key(*base) for base in (HANDOVER, RACE)}


@pytest.mark.parametrize(("base", "change"), SAME)
def test_how_a_task_is_solved_does_not_make_another_task(
    base: tuple[str, ...], change: str, keys: dict[tuple[str, ...], str]
) -> None:
    assert key(*base, change) == keys[base]


@pytest.mark.parametrize(("base", "change"), OTHER)
def test_another_task_is_not_compared(
    base: tuple[str, ...], change: str, keys: dict[tuple[str, ...], str]
) -> None:
    assert key(*base, change) != keys[base]


READY = ("+scenario=double_integrator",)


def ready(*overrides: str) -> str:
    found = config.compose_any(*overrides).task_hash
    assert found
    return found


def test_an_mpcc_that_comes_ready_made_is_its_content_and_its_limits() -> None:
    task = ready(*READY)
    for how in (
        "relaxation=direct",
        "solver=sqpmethod",
        "strategy=relax",
        "seed=3",
        "certificate.stationarity=off",
        "scenario.distance=1",
    ):
        assert ready(*READY, how) == task
    other = [
        ready(*READY, what)
        for what in ("scenario.intervals=49", "scenario.distance=2.0", "certificate.product=1e-3")
    ]
    assert len({task, *other, ready("+scenario=zermelo")}) == 5


def test_an_mpcc_from_a_file_is_what_the_file_says_packed_or_not(tmp_path: Path) -> None:
    said = {
        "a.json": b"{1}",
        "b.json": b"{1}",
        "c.json.gz": gzip.compress(b"{1}"),
        "d.json": b"{2}",
        "e.json.gz": b"{1}",
    }
    for name, data in said.items():
        (tmp_path / name).write_bytes(data)
    first, *others = (ready("+scenario=mpcc_file", f"scenario.path={tmp_path / name}") for name in said)
    assert [one == first for one in others] == [True, True, False, True]


def test_objectives_are_compared_by_their_amount() -> None:
    def found(objective: float, best: float) -> Any:
        known = BestKnown({"a": {"objective": best, "command": ""}})
        return known.compare(make_record(objective=objective, certified=True, task_hash="a"))

    assert found(-1.01, -1.0) == {"best_known_objective": -1.0, "gap_percent": pytest.approx(-1.0)}
    assert found(12.12, 12.0)["gap_percent"] == pytest.approx(1.0)
    assert found(2e-5, 0.0)["gap_percent"] == pytest.approx(2e-3)  # of 1: products of 1e-7 are allowed
    assert beats(-1.1, -1.0) and not beats(-1.0 - 1e-7, -1.0) and not beats(-1e-7, 0.0) and beats(-1e-5, 0.0)
    uncertified = make_record(objective=3.0, certified=False, task_hash="a")
    assert BestKnown({"a": {"objective": 2.0, "command": ""}}).compare(uncertified) == {
        "best_known_objective": 2.0
    }


def test_a_solution_tells_its_gap_and_what_is_published_and_is_kept(tmp_path: Path) -> None:
    task = ("+scenario=double_integrator", "scenario.intervals=6", "scenario.distance=4.0")
    first = told(tmp_path, *task)
    assert first.returncode == 0 and "best known" not in first.stdout
    assert re.search(r"published +4: Bryson & Ho 1975, section 3\.9", first.stdout)
    kept = told(tmp_path, "best", "results")
    assert f"double_integrator, {' '.join(task)}: 4, the first" in kept.stdout, kept.stderr
    again = told(tmp_path, *task, "relaxation=direct")
    assert "(best known 4, +0.000 %)" in again.stdout
    (entry,) = yaml.safe_load((tmp_path / "references" / "best_known.yaml").read_text())
    assert entry["objective"] == pytest.approx(4.0, abs=1e-7) and "travel_time_s" not in entry
    assert ready(*shlex.split(entry["command"])) == entry["task_hash"]
    record = max(records(tmp_path), key=lambda one: one["started_at"])
    assert record["best_known_objective"] == entry["objective"] and record["best_known_s"] is None
    assert record["published_objective"] == 4.0


def test_a_track_is_what_its_file_says_and_not_its_path(tmp_path: Path) -> None:
    one, copy, other = (tmp_path / name for name in ("a.csv", "b.csv", "c.csv"))
    for file, x in ((one, 1), (copy, 1), (other, 2)):
        file.write_text(f"x,y,z\n{x},2,3\n")
    first, same, changed = (
        key("+scenario=race", "scenario.gates=1", f"scenario.track={f}") for f in (one, copy, other)
    )
    assert first == same != changed


def row(folder: Path, time: float, **values: Any) -> Record:
    """A run's folder as the program leaves it, with a made-up travel time."""
    overrides = [*HANDOVER, "scenario.intervals=60", "scenario.rate_margin.arm=0", f"output={folder}"]
    standard = {
        "run_id": folder.name, "scenario": "circle", "dynamics": "verlet", "vehicle": "table1", "intervals": 60,
        "kappa_init": 2, "status": "certified", "certified": True, "travel_time_s": time, "task_hash": key(*overrides),
        "started_at": f"2026-01-01T00:00:{len(folder.name):02d}",
    }  # fmt: skip
    record = make_record(**(standard | values))
    write_record(folder, record)
    write_bytes(folder / ".hydra" / "overrides.yaml", yaml.safe_dump(overrides).encode())
    return record


def merged(file: Path, *folders: Path) -> dict[str, float]:
    assert best.run([*map(str, folders), "--file", str(file)]) == 0
    return {k: float(e["travel_time_s"]) for k, e in BestKnown.load(file).entries.items()}


def test_only_certified_and_better_plans_are_kept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, runs = tmp_path / "mine.yaml", tmp_path / "runs"
    task = row(runs / "a", 3.0)["task_hash"]
    row(runs / "rejected", 2.0, certified=False, status="uncertified")
    assert merged(file, runs) == {task: 3.0}
    assert "3.000000 s, the first" in capsys.readouterr().out
    row(runs / "same", 3.0 * (1 - 0.9e-6))
    before = file.read_bytes()
    assert merged(file, runs) == {task: 3.0} and file.read_bytes() == before
    assert "nothing changed" in capsys.readouterr().out
    row(runs / "better", 3.0 * (1 - 1.1e-6))
    assert merged(file, runs)[task] == pytest.approx(3.0 * (1 - 1.1e-6), rel=1e-12)
    assert "was 3.000000 s" in capsys.readouterr().out


def test_the_command_leaves_out_where_results_go_and_gives_the_task_again(tmp_path: Path) -> None:
    task = row(tmp_path / "run", 3.0)["task_hash"]
    merged(tmp_path / "f.yaml", tmp_path / "run")
    command = BestKnown.load(tmp_path / "f.yaml").entries[task]["command"]
    assert "output" not in command and key(*shlex.split(command)) == task


def test_a_plan_whose_command_is_another_task_is_left_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    row(tmp_path / "run", 3.0, task_hash="0123456789abcdef")
    assert merged(tmp_path / "f.yaml", tmp_path / "run") == {}
    assert "is another task" in capsys.readouterr().err


def test_rewards_are_taken_off() -> None:
    record = make_record(travel_time_s=3.0, reward_s=0.25, certified=True, task_hash="a")
    assert net_time(record) == 2.75
    known = BestKnown({"a": {"travel_time_s": 2.5}})
    assert known.compare(record) == {"best_known_s": 2.5, "gap_percent": pytest.approx(10.0)}
    assert known.compare(record | {"certified": False}) == {"best_known_s": 2.5}
    assert known.compare(record | {"task_hash": "b"}) == {}


def test_own_costs_are_added_also_those_of_a_table() -> None:
    """Numbers by name are pairs in a row of a table, None where one is not known."""
    for costs in ({"height": 0.25, "effort": None}, [("height", 0.25), ("effort", None)]):
        assert net_time({"travel_time_s": 3.0, "reward_s": None, "costs": costs}) == 3.25


def test_runs_with_own_costs_are_kept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    row(tmp_path / "runs" / "a", 3.0, costs={"height": 0.25})
    assert list(merged(tmp_path / "f.yaml", tmp_path / "runs").values()) == [3.25]
    assert "3.250000 s, the first" in capsys.readouterr().out


def test_the_better_of_two_files_counts(tmp_path: Path) -> None:
    ours, theirs = tmp_path / "ours.yaml", tmp_path / "theirs.yaml"
    for file, times in ((ours, {"a": 2.0, "b": 3.0}), (theirs, {"a": 2.5, "b": 2.9, "c": 1.0})):
        BestKnown({k: {"task_hash": k, "travel_time_s": t, "command": ""} for k, t in times.items()}).save(
            file
        )
    for files in ((ours, theirs), (theirs, ours, tmp_path / "none.yaml")):
        found = BestKnown.load(*files).entries
        assert {k: e["travel_time_s"] for k, e in found.items()} == {"a": 2.0, "b": 2.9, "c": 1.0}


@pytest.mark.parametrize(
    "text",
    ["a: 1", "- 3", "- {task_hash: a, command: b}", "- {task_hash: a, travel_time_s: -1.0, command: b}", "["],
)
def test_a_file_that_is_none_is_refused_by_name(tmp_path: Path, text: str) -> None:
    (tmp_path / "f.yaml").write_text(text)
    with pytest.raises(BadInput, match=r"f\.yaml"):
        BestKnown.load(tmp_path / "f.yaml")


def test_folders_without_a_run_are_refused(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    assert_refused(told(tmp_path, "best", "empty"), "empty", "has no record of a run")
    with pytest.raises(BadInput, match="there is no such folder"):
        best.run([str(tmp_path / "nowhere")])
    with pytest.raises(BadInput, match="DIR"):
        best.run([])


@cache
def limits(scenario: str) -> object:
    return composing.case_of(f"+scenario={scenario}").limits


def test_values_that_come_with_benchbench_belong_to_their_commands() -> None:
    """One for each scenario with each dynamics, for each grid and for each kappa_init.

    A field with a new default may orphan them: run them again, or fix `task_hash`.
    """
    known = [e for e in BestKnown.load(packaged()).entries.values() if "travel_time_s" in e]
    entries = {(e["scenario"], e["dynamics"]): e for e in known}
    flights = {n for n in config.choices("scenario") if not n.startswith(("random_", "hardware_"))}
    flights -= {
        "mpcc_file",
        "pympcc",
        "block_move",
        "double_integrator",
        "zermelo",
        "cart_pole",
        "goddard",
        "obstacle_car",
        "quadrotor_flip",
        "robot_arm",
        "steering",
    }  # they are no flights
    assert {scenario for scenario, _ in entries} == flights
    grids = {field: {e.get(field): e for e in known} for field in ("intervals", "kappa_init")}
    some = [e for of in (entries, *grids.values()) for e in of.values()]
    for entry in {e["task_hash"]: e for e in some}.values():
        case = composing.case_of(*shlex.split(entry["command"]))
        assert case.task_hash == entry["task_hash"]
        assert (case.scenario.name, case.scenario.grid_intervals) == (entry["scenario"], entry["intervals"])
        assert case.limits == limits(entry["scenario"])


def test_objectives_that_come_with_benchbench_belong_to_their_commands(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of all classics and pympcc's problems, and of the example that stands beside the package."""
    examples = Path(__file__).resolve().parents[1] / "examples"
    monkeypatch.setattr(sys, "path", [*sys.path, str(examples / "block_and_wall")])
    entries = [e for e in BestKnown.load(packaged()).entries.values() if "objective" in e]
    by_name = {e["scenario"]: e for e in entries}
    assert {*suite("classics")[1].scenario, "block_and_wall", "kth1", "bilevel1"} <= by_name.keys()
    for entry in by_name.values():
        command = shlex.split(entry["command"])
        if command[0] == "--config-dir":
            command = [*command[2:], f"hydra.searchpath=['file://{examples.parent / command[1]}']"]
        case = config.compose_any(*command)
        assert (case.task_hash, case.scenario.name) == (entry["task_hash"], entry["scenario"])


def test_values_of_suites_belong_to_their_commands() -> None:
    """One in 20, of each family at least one; all are told apart from those of plain scenarios."""
    entries = list(BestKnown.load(packaged(OF_SUITES)).entries.values())
    families = {e["scenario"].rpartition("_")[0]: e for e in entries}
    assert (
        set(families) <= {"random_handover", "random_hardware", "random_race", "random_delivery"}
        and len(families) >= 3
    )
    assert not {e["task_hash"] for e in entries} & set(BestKnown.load(packaged()).entries)
    for entry in {e["task_hash"]: e for e in [*entries[::20], *families.values()]}.values():
        case = composing.case_of(*shlex.split(entry["command"]))
        assert (case.task_hash, case.scenario.name) == (entry["task_hash"], entry["scenario"])
        assert BestKnown.load(packaged(OF_SUITES)).compare(
            {"task_hash": entry["task_hash"], "travel_time_s": 2 * entry["travel_time_s"], "reward_s": 0.0, "certified": True}
        ) == {"best_known_s": entry["travel_time_s"], "gap_percent": pytest.approx(100.0)}  # fmt: skip


REACHED = {
    ("static", "verlet", 100): 2.688, ("linear", "verlet", 100): 2.663, ("circle", "verlet", 100): 2.854,
    ("static", "verlet", 200): 2.679, ("linear", "verlet", 200): 2.654, ("circle", "verlet", 200): 2.838,
    ("static", "collocation", 50): 2.725, ("static", "collocation", 25): 2.883,
}  # fmt: skip
"""Certified travel times in s that scans over all contact windows found, kappa_init = 2."""


def test_values_that_come_with_benchbench_are_at_least_those_of_scans() -> None:
    known = {
        (e["scenario"], e["dynamics"], e["intervals"]): e["travel_time_s"]
        for e in BestKnown.load(packaged()).entries.values()
        if e.get("kappa_init") == 2 and e["vehicle"] == "table1"
    }
    assert all(known[task] <= travel_time for task, travel_time in REACHED.items())


def test_a_run_tells_its_gap_and_what_beats_it(tmp_path: Path) -> None:
    """A real plan against a value that is too good, then against one that it beats; then it is kept."""
    task = ("+scenario=static", *SMALL)
    plan = pipeline.run(composing.case_of(*task)).record
    assert plan["certified"] and plan["best_known_s"] is None and plan["gap_percent"] is None
    file = tmp_path / "references" / "best_known.yaml"
    entry = {
        "task_hash": plan["task_hash"],
        "travel_time_s": plan["travel_time_s"] / 1.02,
        "command": "+scenario=static",
    }
    BestKnown({plan["task_hash"]: entry}).save(file)
    above = told(tmp_path, *task, "picture=false")
    assert (
        f"best known {entry['travel_time_s']:.4f} s, +2.000 %" in above.stdout
        and "new best" not in above.stdout
    )
    BestKnown({plan["task_hash"]: entry | {"travel_time_s": plan["travel_time_s"] * 1.01}}).save(file)
    below = told(tmp_path, *task, "picture=false")
    assert "new best" in below.stdout
    gaps = [r["gap_percent"] for r in sorted(records(tmp_path), key=lambda r: r["started_at"])]
    assert gaps == pytest.approx([2.0, 100 * (1 / 1.01 - 1)], abs=1e-6)
    keep = next(line for line in below.stdout.splitlines() if line.startswith("keep it"))
    done = told(tmp_path, *shlex.split(keep.removeprefix("keep it").strip())[1:])
    assert done.returncode == 0 and "1 changed" in done.stdout
    kept = BestKnown.load(file).entries[plan["task_hash"]]
    assert kept["travel_time_s"] == pytest.approx(plan["travel_time_s"], rel=1e-9)
