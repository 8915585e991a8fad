"""The public CPC planner of Foehn, Romero & Scaramuzza 2021 (doi:10.1126/scirobotics.abh1221), in Python with CasADi.

Its modules are loaded from the user's checkout by a driver of ours, without its plots. It takes one distance for all
gates, limits |wx| and |wy| alike, has g = 9.801 m/s^2 and the ground at 0.5 m in its code, and holds thrusts per node.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, ClassVar, final

import yaml  # type: ignore[import-untyped]
from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.ground.errors import IncompatibleCase
from benchbench.ocp.race import Race
from benchbench.planning.peer import Call, Peer, Racer, balls

MODULES = ("track", "quad", "integrator", "planner", "trajectory")
GRAVITY = 9.801
DRIVER = """
import sys
sys.path.insert(0, sys.argv[1])
from integrator import RungeKutta4
from planner import Planner
from quad import Quad
from track import Track
from trajectory import Trajectory

tolerance, nodes, speed = float(sys.argv[2]), int(sys.argv[3]), float(sys.argv[4])
options = {"tolerance": tolerance, "nodes_per_gate": nodes, "vel_guess": speed}
planner = Planner(Quad("quad.yaml"), Track("track.yaml"), RungeKutta4, options)
planner.setup()
Trajectory(planner.solve(), NPW=planner.NPW, wp=planner.wp).save("result.csv", True)
"""


@final
@dataclass(frozen=True)
class Cpc(Peer):
    """Public CPC planner (rpg_time_optimal): complementary progress constraints, RK4, IPOPT.

    folder       its checkout
    python       the interpreter to run it with, which has casadi, numpy, matplotlib and pyyaml; None: our own
    speed_guess  m/s, as in its example
    """

    folder: Path | None = None
    python: str | None = None
    speed_guess: Annotated[float, Field(gt=0)] = 3.0
    name: ClassVar[str] = "cpc"

    def missing(self) -> str:
        """Its folder with its modules."""
        if self.folder is None:
            return "peer.folder is not given; it is a checkout of the public planner rpg_time_optimal"
        absent = [m for m in MODULES if not (self.folder / "src" / f"{m}.py").is_file()]
        return (
            f"'{self.folder}' has no src/{absent[0]}.py; needed is a checkout of rpg_time_optimal"
            if absent
            else ""
        )

    def call(self, race: Race, racer: Racer, work: Path) -> Call:
        """Track and vehicle as its YAML."""
        balls(race, self.name)
        (x, y, z), radii = racer.body_rate, sorted({gate.radius for gate in race.goals})
        for field, fits, allowed in (
            ("scenario.radius", len(radii) == 1, "one radius for all gates and the end"),
            ("scenario.end_velocity", race.end_velocity != "rest", "free, or a velocity"),
            ("vehicle.body_rate", x == y, "the same limit about x and y"),
            ("vehicle.gravity", racer.gravity == GRAVITY, f"{GRAVITY}, as in its code"),
        ):
            if not fits:
                raise IncompatibleCase(field, f"is nothing that peer '{self.name}' can be asked for", allowed)
        still = {"attitude": [1, 0, 0, 0], "velocity": [0, 0, 0], "omega": [0, 0, 0]}
        end = {"position": list(race.goals[-1].position)}
        if not isinstance(race.end_velocity, str):
            end["velocity"] = list(race.end_velocity)
        gates = [list(gate.position) for gate in race.goals[:-1]]
        track = {"gates": gates, "initial": {"position": list(race.start_position), **still}, "end": end}
        inertia = [[racer.inertia[i] if i == j else 0.0 for j in range(3)] for i in range(3)]
        quad = {
            "mass": racer.mass, "arm_length": racer.lever, "inertia": inertia, "thrust_min": racer.motor_force[0],
            "thrust_max": racer.motor_force[1], "omega_max_xy": x, "omega_max_z": z, "torque_coeff": racer.torque_coefficient,
        }  # fmt: skip
        for name, told in (("track.yaml", track), ("quad.yaml", quad)):
            (work / name).write_text(yaml.safe_dump(told))
        (work / "driver.py").write_text(DRIVER)
        source = str((self.folder or Path()).resolve() / "src")
        numbers = [str(radii[0]), str(race.nodes_per_gate), str(self.speed_guess)]
        command = [self.python or sys.executable, "driver.py", source, *numbers]
        return Call(command, work, work / "result.csv", "hold")
