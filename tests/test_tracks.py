"""Tracks from lists, YAML and CSV, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import cast

import pytest

from benchbench.ground.errors import BadInput
from benchbench.ocp.race import Race
from benchbench.ocp.track import Gate
from benchbench.ocp.track_file import read
from benchbench.run import config

LAP = [[0.0, 0.0, 1.0], [5.0, 0.0, 1.0], [5.0, 5.0, 2.0]]


def race(*overrides: str) -> Race:
    return cast("Race", config.compose("+scenario=race", *overrides).scenario)


def test_the_same_track_from_a_list_from_csv_and_from_yaml(tmp_path: Path) -> None:
    wanted = (Gate((0.0, 0.0, 1.0), 0.3), Gate((5.0, 0.0, 1.0), 0.4), Gate((5.0, 5.0, 2.0), 0.3))
    rows = [LAP[0], {"x": 5, "y": 0, "z": 1, "radius": 0.4}, LAP[2]]
    assert read(rows, 0.3).lap == wanted
    table = tmp_path / "track.csv"
    table.write_text("# shuffled\nx,y,z,radius,order\n5,5,2,0.3,30\n0,0,1,0.3,10\n\n5,0,1,0.4,20\n")
    assert read(table, 1.0).lap == wanted
    listed = tmp_path / "track.yaml"
    listed.write_text("- [0, 0, 1]\n- {x: 5, y: 0, z: 1, radius: 0.4}\n- [5, 5, 2]\n")
    assert read(str(listed), 0.3).lap == wanted


def test_gates_of_all_kinds_from_yaml_and_from_csv(tmp_path: Path) -> None:
    listed = tmp_path / "track.yaml"
    listed.write_text(
        "- {x: 0, y: 0, z: 1, speed: [2, 6]}\n"
        "- {x: 5, y: 0, z: 1, width: 1.2, height: 0.8, yaw: 1.5707963267948966, heading: 0.5}\n"
        "- {x: 5, y: 5, z: 2, width: 2, height: 2, normal: [0, 3, 4], direction: against, speed: 3}\n"
    )
    table = tmp_path / "track.csv"
    table.write_text(
        "x,y,z,radius,width,height,yaw,nx,ny,nz,direction,speed_min,speed_max,heading\n"
        "0,0,1,0.3,,,,,,,,2,6,\n5,0,1,,1.2,0.8,1.5707963267948966,,,,,,,0.5\n5,5,2,,2,2,,0,3,4,against,2.98,3.02,\n"
    )
    ball, upright, tilted = read(listed, 0.3).lap
    assert read(table, 0.3).lap == (ball, upright, tilted)
    assert (ball.radius, ball.speed, ball.opening) == (0.3, (2.0, 6.0), None)
    assert upright.opening is not None and tilted.opening is not None
    assert upright.opening.normal == pytest.approx((0, 1, 0)) and upright.heading == 0.5
    assert upright.opening.sides[0] == pytest.approx((-1, 0, 0)) and upright.opening.sides[
        1
    ] == pytest.approx((0, 0, 1))
    assert tilted.opening.normal == pytest.approx((0, 0.6, 0.8)) and tilted.speed == pytest.approx(
        (2.98, 3.02)
    )
    assert tilted.radius == pytest.approx(2**0.5)


def test_a_yaml_file_may_bring_start_end_and_radius(tmp_path: Path) -> None:
    file = tmp_path / "track.yml"
    file.write_text(f"start: [1, 2, 3]\nend: [9, 9, 1]\nlap: {LAP}\nradius: 0.5\ngates: 5\n")
    scenario = race(f"scenario.track={file}", "scenario.gates=null")
    assert scenario.start_position == (1.0, 2.0, 3.0)
    assert [gate.position[0] for gate in scenario.goals] == [0, 5, 5, 0, 5, 9]
    assert {gate.radius for gate in scenario.goals[:-1]} == {0.5}
    assert scenario.grid_intervals == 6 * 40


def test_what_is_typed_wins_over_the_file_and_the_file_over_what_is_shipped(tmp_path: Path) -> None:
    file = tmp_path / "track.yaml"
    file.write_text(f"start: [1, 2, 3]\nend: [9, 9, 1]\nlap: {LAP}\nradius: 0.5\ngates: 2\n")
    plain = race(f"scenario.track={file}")
    assert (plain.gates, plain.radius, plain.start["x"], plain.end["x"]) == (2, 0.5, 1, 9), (
        "the configuration says it"
    )
    assert plain.start_position == (1, 2, 3) and len(plain.goals) == 3 and plain.goals[0].radius == 0.5
    typed = race(
        f"scenario.track={file}",
        "scenario.gates=3",
        "scenario.radius=0.2",
        "scenario.start.x=-1",
        "scenario.end={x:8,y:8,z:2}",
    )
    assert typed.start_position == (-1, 2, 3), "the other coordinates are the file's"
    assert typed.goals[-1].position == (8, 8, 2) and len(typed.goals) == 4 and typed.goals[0].radius == 0.2


def test_the_public_track_repeats_its_lap() -> None:
    scenario = race("scenario.gates=19")
    assert len(scenario.goals) == 20
    assert scenario.goals[0] == scenario.goals[7] == scenario.goals[14]
    by_hand = (3.9**2 + 6.1**2 + 2.4**2) ** 0.5 + (5.85**2 + 0.7**2 + 2.4**2) ** 0.5
    case = config.compose("+scenario=race", "scenario.gates=1")
    assert case.scenario.flown(case.model, 2)[-1] == pytest.approx(by_hand)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("x,y\n1,2\n", "header 'x,y'"),
        ("x,y,z,colour\n1,2,3,4\n", "track.colour: does not exist"),
        ("x,y,z,raduis\n1,2,3,4\n", "perhaps 'radius'"),
        ("x,y,z,width,height\n1,2,3,1,\n", "gate 1, height: is missing"),
        ("x,y,z,width,height\n1,2,3,1,1\n", "yaw and normal: are both missing"),
        ("x,y,z,width,height,yaw,nx\n1,2,3,1,1,0,1\n", "yaw and normal: are both given"),
        ("x,y,z,width,height,nx,ny,nz\n1,2,3,1,1,0,0,0\n", "normal: .* a direction"),
        ("x,y,z,width,height,yaw,radius\n1,2,3,1,1,0,1\n", "radius: is given beside"),
        ("x,y,z,width,height,yaw,direction\n1,2,3,1,1,0,up\n", "direction: 'up'"),
        ("x,y,z,width,height,yaw\n1,2,3,-1,1,0\n", "width: -1 m was given"),
        ("x,y,z,speed_min,speed_max\n1,2,3,5,4\n", "speed: .* the first below the second"),
        ("x,y,z,heading\n1,2,3,north\n", "heading: 'north' was given; allowed: an angle in rad"),
        ("x,y,z\n1,2\n", "gate 1: has 2 columns"),
        ("x,y,z\n1,2,three\n", "gate 1: 'three'"),
        ("x,y,z\n1,2,nan\n", "gate 1: 'nan'"),
        ("x,y,z\n", "has no gates"),
        ("", "header ''"),
        ("x,y,z,radius\n1,2,3,0\n", "radius: 0 m"),
        ("x,y,z,radius\n1,2,3,nan\n", "radius: 'nan' was given; allowed: a radius above 0 m"),
        ("x,y,z,order\n1,2,3,1\n2,2,3,1\n", "order"),
    ],
)
def test_bad_csv_is_refused_with_its_place(tmp_path: Path, text: str, said: str) -> None:
    file = tmp_path / "track.csv"
    file.write_text(text)
    with pytest.raises(BadInput, match=said):
        read(file, 0.3)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("lap: [", "is no YAML"),
        ("start: [0, 0, 1]", "has no gates"),
        ("lap: []", "has no gates"),
        ("lap: [[0, 0, 1]]\nspeed: 3", "scenario.track.speed: does not exist"),
        ("lap: [[0, 0, 1]]\ngates: 0", "gates: 0"),
        ("lap: [{x: 1, y: 2}]", "gate 1"),
        ("- {x: 1, y: 2, z: 1, raduis: 3}", "perhaps 'radius'"),
        ("lap: [[0, 0, 1]]\nstart: here", "start: 'here'"),
    ],
)
def test_bad_yaml_is_refused_with_its_place(tmp_path: Path, text: str, said: str) -> None:
    file = tmp_path / "track.yaml"
    file.write_text(text)
    with pytest.raises(BadInput, match=said):
        read(file, 0.3)


@pytest.mark.parametrize(
    ("override", "said"),
    [
        ("scenario.track=nowhere.csv", "cannot read 'nowhere.csv'"),
        ("scenario.track=track.txt", "is no track"),
        ("scenario.gates=6", "the end is where gate 6 is, .* another scenario.end"),
        ("scenario.gates=13", "the end is where gate 13 is"),
        ("scenario.gates=0", "scenario.gates: 0 was given"),
        ("scenario.end_velocity=fast", "free, rest"),
        ("scenario.end_velocity=[1,2]", r"scenario.end_velocity: \[1, 2\] was given; allowed: free, rest"),
        ("scenario.end_velocity=[1,2,nan]", "scenario.end_velocity: .* allowed: free, rest"),
        ("scenario.track=3", "scenario.track: 3 was given; allowed: a list of gates, or the path"),
        ("scenario.track=null", "scenario.track: None was given"),
        ("+scenario.kappa_init=3", "scenario.kappa_init: means nothing in a race"),
        ("+scenario.intervals=30", "nodes_per_gate"),
        ("scenario.radius=-1", "scenario.radius"),
        ("+scenario.raduis=1", "perhaps 'radius'"),
        ("scenario.nodes_per_gate=1", "scenario.nodes_per_gate"),
    ],
)
def test_a_bad_race_is_refused_with_its_field(override: str, said: str) -> None:
    with pytest.raises(BadInput, match=said):
        race(override)
