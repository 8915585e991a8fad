"""TOGT-Planner (Qin, Michet, Chen & Liu, ICRA 2024), polynomials, in C++, built by the user.

Its programs read ../parameters and ../resources from where they run, and write ../resources/trajectory: they run in a
copy of these folders in which track and limits are ours. Limits are soft there; the plan is sampled at 10 ms.
"""

from __future__ import annotations

import math
import re
import shutil
from pathlib import Path
from typing import Any, ClassVar, final

import yaml  # type: ignore[import-untyped]
from pydantic.dataclasses import dataclass

from benchbench.ground.errors import IncompatibleCase
from benchbench.ocp.race import Race
from benchbench.planning.peer import Call, Peer, Racer, balls


@final
@dataclass(frozen=True)
class Togt(Peer):
    """TOGT-Planner: time-optimal polynomials through gates, soft limits.

    folder     its checkout with what was built
    program    what to run in it, relative to the folder, and its arguments
    parameters, track, result   names of its folder of parameters, of the track and of the CSV that this program uses
    """

    folder: Path | None = None
    program: tuple[str, ...] = ("build/tests", "--gtest_filter=AosTest.*")
    parameters: str = "cpc"
    track: str = "race_uzh_19wp.yaml"
    result: str = "aos_traj.csv"
    name: ClassVar[str] = "togt"

    def missing(self) -> str:
        """Its folder, its parameters and its program."""
        if self.folder is None:
            return "peer.folder is not given; it is a checkout of TOGT-Planner with what was built in it"
        for needed in (self.program[0], f"parameters/{self.parameters}"):
            if not (self.folder / needed).exists():
                return f"'{self.folder}' has no {needed}; needed is a checkout of TOGT-Planner, built"
        if place := _compiled_in(self.folder, self.folder / self.program[0]):
            return (
                f"the program has the path '{place}' compiled in (PROJECT_ROOT in its tests), so it would plan its own track and "
                'overwrite files there; build a version that reads ../parameters, or one with PROJECT_ROOT=".."'
            )
        return ""

    def call(self, race: Race, racer: Racer, work: Path) -> Call:
        """Its own folders with our track and limits."""
        balls(race, self.name)
        if race.end_velocity == "free":
            problem = f"is nothing that peer '{self.name}' can be asked for"
            raise IncompatibleCase("scenario.end_velocity", problem, "rest, or a velocity")
        source = (self.folder or Path()).resolve()
        shutil.copytree(source / "parameters", work / "parameters")
        for folder in ("build", "resources/racetrack", "resources/trajectory"):
            (work / folder).mkdir(parents=True)
        _write(work / "resources" / "racetrack" / self.track, _track(race, racer))
        for path in (work / "parameters" / self.parameters).rglob("*.yaml"):
            _limit(path, race, racer)
        command = [str(source / self.program[0]), *self.program[1:]]
        result = work / "resources" / "trajectory" / self.result
        parameters = work / "parameters" / self.parameters
        by_arm = any("armLength" in _told(path) for path in parameters.rglob("*.yaml"))
        motors = "agilicious" if by_arm else "ours"
        return Call(command, work / "build", result, "linear", _each_time_once, motors)


def _compiled_in(folder: Path, program: Path) -> str:
    """The path of a checkout that a program uses as it stands in it, "" where there is none.

    It is the checkout's, or the one that CMake says it was built from; paths of source files, as debuggers want them, do not count.
    """
    cache = folder / "build" / "CMakeCache.txt"
    told = cache.read_text(errors="replace").splitlines() if cache.is_file() else []
    homes = [line.partition("=")[2] for line in told if line.startswith("CMAKE_HOME_DIRECTORY:")]
    data = program.read_bytes()
    for place in (str(folder.resolve()), str(folder.absolute()), *homes):
        used = re.escape(place.rstrip("/").encode()) + rb"(?:/|/(?:parameters|resources)[^\0]*)?\0"
        if re.search(rb"\0" + used, data):
            return place
    return ""


def _each_time_once(text: str) -> str:
    """Leave out rows whose time (first column) is that of the row before: its last row comes twice."""
    lines = text.splitlines(keepends=True)
    times = [line.partition(",")[0] for line in lines]
    return "".join(
        line for line, now, before in zip(lines, times, ["", *times], strict=False) if now != before
    )


def _track(race: Race, racer: Racer) -> dict[str, Any]:
    still = {key: [0.0, 0.0, 0.0] for key in ("vel", "acc", "jer", "euler")}
    still |= {"rot": [1.0, 0.0, 0.0, 0.0], "cthrustmass": racer.gravity}  # type: ignore[dict-item]
    end = [0.0, 0.0, 0.0] if isinstance(race.end_velocity, str) else list(race.end_velocity)
    gates = {
        f"Gate{i}": {
            "type": "SingleBall", "position": list(gate.position), "radius": gate.radius, "margin": 0.0, "stationary": True,
        }
        for i, gate in enumerate(race.goals[:-1], 1)
    }  # fmt: skip
    first, last = list(race.start_position), list(race.goals[-1].position)
    states = {"initState": {**still, "pos": first}, "endState": {**still, "pos": last, "vel": end}}
    return {**states, "orders": list(gates), **gates}


def _limit(path: Path, race: Race, racer: Racer) -> None:
    """Write vehicle and limits into one of its files, where it has these fields."""
    told = _told(path)
    low, high = race.workspace.get("z", (-1e4, 1e4))
    (x, y, z), (least, most) = racer.body_rate, racer.motor_force
    lever, yaw = racer.lever, racer.torque_coefficient
    mixer = [
        [1.0] * 4,
        [lever, -lever, -lever, lever],
        [-lever, -lever, lever, lever],
        [yaw, -yaw, yaw, -yaw],
    ]
    ours = {
        "mass": racer.mass, "gravity": racer.gravity, "inertia": list(racer.inertia), "T_bm": mixer, "maxThr": most,
        "minThr": least, "maxOmgXY": min(x, y), "maxOmgZ": z, "boundZ": [low, high],
        "armLength": lever * math.sqrt(2), "beta": 45.0, "torCoeff": yaw,
    }  # fmt: skip
    if told:
        _write(path, {**told, **{key: value for key, value in ours.items() if key in told}})


def _told(path: Path) -> dict[str, Any]:
    """What a file of parameters says, nothing where it is no mapping."""
    told = yaml.safe_load(path.read_text())
    return told if isinstance(told, dict) else {}


def _write(path: Path, told: dict[str, Any]) -> None:
    path.write_text(yaml.safe_dump(told, sort_keys=False))
