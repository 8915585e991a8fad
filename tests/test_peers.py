"""External planners, by stand-ins of ours that read and write what the public ones do: good, bad and none at all."""

from __future__ import annotations

import json
from pathlib import Path

import composing
import pytest
from peer_stand_in import cpc_folder, togt_folder
from program import told
from test_foreign import task

from benchbench.ground.errors import Crash, IncompatibleCase, NoPlan, Timeout, Unavailable
from benchbench.run import pipeline

FOLDERS = {"cpc": cpc_folder, "togt": togt_folder}
END = {"cpc": "free", "togt": "rest"}


def planned(peer: str, folder: Path, *more: str) -> pipeline.Run:
    end = f"scenario.end_velocity={END[peer]}"
    return pipeline.run(
        composing.case_of(*task(), end, "strategy=peer", f"peer={peer}", f"peer.folder={folder}", *more)
    )


@pytest.mark.parametrize("peer", FOLDERS)
def test_the_plan_of_a_peer_is_certified_like_ours(peer: str, tmp_path: Path) -> None:
    folder = FOLDERS[peer](tmp_path / "theirs")
    before = sorted(folder.rglob("*"))
    done = planned(peer, folder)
    assert done.certificate.certified, done.certificate.reasons
    assert (done.record["strategy"], done.record["solver"], done.record["gates_passed"]) == ("peer", peer, 2)
    assert done.record["solve_cpu_s"] > 0.1  # its own process
    assert [
        f for f in sorted(folder.rglob("*")) if "__pycache__" not in f.parts
    ] == before  # nothing is written there


def test_a_bad_plan_of_a_peer_is_rejected(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PEER", "spoil")
    done = planned("cpc", cpc_folder(tmp_path / "theirs"))
    assert done.record["status"] == "uncertified" and "defect" in done.certificate.reasons[0]


@pytest.mark.parametrize("peer", FOLDERS)
@pytest.mark.parametrize(
    ("what", "error", "said"),
    [
        ("hang", Timeout, "did not end within 2 s"),
        ("crash", Crash, "died of SIGSEGV"),
        ("give_up", Crash, "exit code 3; it says: no solution found"),
        ("rubbish", NoPlan, "wrote what is no plan: .*csv: has 1 rows of numbers"),
        ("silent", NoPlan, "wrote no plan; it says: Second optimization fails!"),
    ],
)
def test_a_peer_without_a_plan(
    peer: str, what: str, error: type[Exception], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PEER", what)
    limit = ["strategy.wall_limit=2"] if what == "hang" else []
    with pytest.raises(error, match=f"peer '{peer}' .*{said}"):
        planned(peer, FOLDERS[peer](tmp_path / "theirs"), *limit)


def test_what_is_not_there_or_cannot_be_asked(tmp_path: Path) -> None:
    for peer, needed in (("cpc", "rpg_time_optimal"), ("togt", "TOGT-Planner")):
        with pytest.raises(Unavailable, match=f"'{tmp_path}' has no .* needed is a checkout of {needed}"):
            planned(peer, tmp_path)
    cpc, togt = cpc_folder(tmp_path / "cpc"), togt_folder(tmp_path / "togt")
    for peer, folder, override, said in (
        ("cpc", cpc, "scenario.end_velocity=rest", "scenario.end_velocity"),
        ("cpc", cpc, "scenario.end_radius=0.1", "one radius for all gates"),
        ("cpc", cpc, "vehicle.gravity=9.81", "9.801, as in its code"),
        ("cpc", cpc, "vehicle=race_ramp", "flat limits"),
        ("togt", togt, "scenario.end_velocity=free", "rest, or a velocity"),
        ("togt", togt, "scenario.track=[{x:-3,y:3,z:2,speed:3},[0,2,1.6]]", "gate 1 is more"),
    ):
        with pytest.raises(IncompatibleCase, match=said):
            planned(peer, folder, override)


def test_a_peer_that_hangs_costs_one_row(tmp_path: Path) -> None:
    folder = cpc_folder(tmp_path / "theirs")
    done = told(
        tmp_path,
        *task(),
        "strategy=peer",
        "peer=cpc",
        f"peer.folder={folder}",
        "strategy.wall_limit=1",
        PEER="hang",
    )
    assert done.returncode == 1 and "did not end within 1 s" in done.stderr
    (path,) = tmp_path.rglob("record.json")
    record = json.loads(path.read_text())
    assert (record["status"], record["solver"], record["strategy"]) == ("timeout", "cpc", "peer")
