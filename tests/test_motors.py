"""Plans that number the motors in another way: recognised by their first intervals, read by name or by number."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from flights import table_one
from peer_stand_in import togt_folder
from simulator import Flown
from test_foreign import certify, good, judge, task

from benchbench.ground.errors import BadInput, Unavailable
from benchbench.planning.motors import conventions, hint, order_of, places, reordered
from benchbench.run import config, pipeline
from benchbench.run.summary import lines
from benchbench.storage.attached import attached
from benchbench.storage.multirotor import trajectory_of
from benchbench.storage.plan_file import read_plan
from benchbench.storage.ros2 import to_mcap
from benchbench.storage.schema import make_record

OTHER = (4, 1, 3, 2)
RACE = config.compose(*task())


def renumbered(flown: Flown) -> Flown:
    """The same flight as Agilicious numbers the motors: their front right is 1, back left 2, back right 3, front left 4."""
    rows = flown.rows.copy()
    for ours, theirs in enumerate(OTHER):
        rows[:, 13 + theirs] = flown.rows[:, 14 + ours]
    return Flown(rows)


def test_where_the_motors_of_our_vehicles_stand() -> None:
    assert places(RACE.model) == ("front left", "front right", "back right", "back left")
    assert conventions(RACE.model) == {"cpc": (1, 2, 3, 4), "agilicious": OTHER, "px4": (3, 1, 4, 2)}
    assert places(table_one()) == ("front right", "back left", "front left", "back right")
    assert order_of("px4", table_one()) == (1, 2, 3, 4)


def test_another_order_is_recognised_and_read(tmp_path: Path) -> None:
    plan = good().csv()
    assert plan != renumbered(good()).csv()
    done = certify(tmp_path, renumbered(good()).csv(), "picture=false")
    said = " ".join(done.stdout.split())
    assert done.returncode == 1 and "--motors 4,1,3,2 (as agilicious)" in said
    assert "NOT certified (the plan is by foreign)" in said and "solver claims" not in said
    for motors in ("4,1,3,2", "agilicious"):
        told = certify(tmp_path, renumbered(good()).csv(), "--motors", motors, "picture=false")
        assert told.returncode == 0, told.stdout
    again = certify(tmp_path, good().csv(), "--motors", "4,1,3,2", "picture=false")
    assert "(as cpc)" in " ".join(again.stdout.split()), "it is told also where the wrong one was typed"


def test_another_lever_is_recognised(tmp_path: Path) -> None:
    (tmp_path / "plan.csv").write_text(renumbered(good()).csv())
    model = replace(RACE.model, lever=0.21)
    plan = read_plan(tmp_path / "plan.csv", model)
    said = hint(plan, model, RACE.limits, (1, 2, 3, 4))
    assert "--motors 4,1,3,2" in said and "vehicle.lever=0.15" in said
    assert hint(reordered(plan, OTHER), RACE.model, RACE.limits, OTHER) == ""


def test_what_fits_no_order_is_said_nothing_of(tmp_path: Path) -> None:
    spoiled = good().changed(14, slice(None), 1.5).changed(11, slice(1, None), 0.4)
    assert not judge(spoiled, tmp_path).certified
    plan = read_plan(tmp_path / "flight.csv", RACE.model)
    assert hint(plan, RACE.model, RACE.limits, (1, 2, 3, 4)) == ""


@pytest.mark.parametrize("motors", ["[1,1,2,3]", "[0,1,2,3]", "px5"])
def test_an_order_that_is_none_is_refused(motors: str, tmp_path: Path) -> None:
    (tmp_path / "plan.csv").write_text(good().csv())
    case = config.compose(
        *task(), "strategy=foreign", f"strategy.file={tmp_path}/plan.csv", f"strategy.motors={motors}"
    )
    with pytest.raises(BadInput, match=r"strategy\.motors: .*agilicious"):
        pipeline.run(case)


def test_an_exported_ros_2_file_is_certified_like_its_csv(tmp_path: Path) -> None:
    (tmp_path / "plan.csv").write_text(good().csv())
    plan = read_plan(tmp_path / "plan.csv", RACE.model)
    (tmp_path / "ros.mcap").write_bytes(to_mcap(trajectory_of(plan), {"config": ""}))
    again = read_plan(tmp_path / "ros.mcap", RACE.model)
    for name in ("time", "configuration", "velocity", "inputs"):
        np.testing.assert_allclose(getattr(again, name), getattr(plan, name), atol=1e-12)
    (tmp_path / "none.mcap").write_bytes(b"\x89MCAP0")
    assert attached(tmp_path / "none.mcap") is None


@pytest.mark.parametrize("how", ["program", "cmake"])
def test_a_planner_that_would_write_into_its_checkout_is_refused(how: str, tmp_path: Path) -> None:
    folder = togt_folder(tmp_path / "theirs")
    place = folder if how == "program" else Path("/home/somebody/TOGT-Planner")
    (folder / "build" / "CMakeCache.txt").write_text(f"CMAKE_HOME_DIRECTORY:INTERNAL={place}\n")
    program = folder / "build" / "tests"
    harmless = program.read_bytes() + f"\0{place}/src/race/race_planner.cpp\0{place}/build/tests\0".encode()
    program.write_bytes(harmless)
    command = (*task(), "scenario.end_velocity=rest", "strategy=peer", "peer=togt", f"peer.folder={folder}")
    assert config.compose(*command).strategy.planner.missing() == ""  # type: ignore[attr-defined]
    program.write_bytes(harmless + f"\0{place}\0".encode())
    with pytest.raises(
        Unavailable, match=r"has the path .* compiled in \(PROJECT_ROOT.*overwrite files there"
    ):
        pipeline.run(config.compose(*command))


@pytest.mark.parametrize(
    ("miss", "passed", "reasons", "said"),
    [
        (-0.05, 19, (), "19 of 19 in order, 50 mm inside the edge at the tightest"),
        (0.004, 19, (), "19 of 19 in order, 4 mm outside the edge at worst"),
        (1.78, 19, ("the end is passed at 2 m",), "19 of 19 in order, but the end is missed by 1.78 m"),
        (0.4, 3, ("gate 4 is passed at 0.7 m", "the end is passed at 2 m"), "3 of 19 in order, 400 mm outside the edge at worst"),
        (None, 0, (), "0 of 19 in order"),
    ],
)  # fmt: skip
def test_gates_are_told_in_a_sentence(
    miss: float | None, passed: int, reasons: tuple[str, ...], said: str
) -> None:
    record = make_record(
        scenario="race", intervals=9, gates=19, gates_passed=passed, gate_worst_miss_m=miss, reasons=reasons, status="uncertified",
        claimed_success=True, certified=False, iterations=0,
    )  # fmt: skip
    assert dict(lines(record))["gates"] == said
