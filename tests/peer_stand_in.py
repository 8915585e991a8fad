"""Stand-ins for public planners, written by us: the same input YAML and the same CSV, the flight by our simulator.

What they do besides is told by the environment variable PEER: fly, hang, crash, give_up, rubbish, silent, spoil.
"""

from __future__ import annotations

import os
import signal
import stat
import sys
import textwrap
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

if TYPE_CHECKING:
    from simulator import Flown

HERE = str(Path(__file__).parent)


def answer(places: list[Any], linear: bool, rest: bool) -> Flown | str:
    """What is written: a flight, or rubbish; or nothing ever comes."""
    what = os.environ.get("PEER", "fly")
    if what == "hang":
        time.sleep(600)
    if what == "crash":
        os.kill(os.getpid(), signal.SIGSEGV)
    if what == "give_up":
        print("no solution found")
        sys.exit(3)
    if what == "rubbish":
        return "t,p_x,p_y\n0,zero,one\n"
    if what == "silent":
        print("Second optimization fails!")
        sys.exit(0)
    from simulator import fly  # half a second, which those without a flight need not take

    flown = fly(places, step=0.01 if linear else 0.02, linear=linear, rest=rest)
    return flown.changed(1, slice(50, None), 0.3) if what == "spoil" else flown


def togt() -> None:
    """TOGT-Planner's program: reads and writes below .. of where it runs; 5 digits, the last row twice."""
    track = yaml.safe_load(Path("../resources/racetrack/race_uzh_19wp.yaml").read_text())
    limits = yaml.safe_load(Path("../parameters/cpc/refine/cpc_planning.yaml").read_text())
    assert limits["maxThr"] == 6.8794 and limits["boundZ"] == [0.5, 100.0] and limits["piecesPerSegment"] == 5
    places = [
        track["initState"]["pos"],
        *(track[name]["position"] for name in track["orders"]),
        track["endState"]["pos"],
    ]
    found = answer(places, linear=True, rest=track["endState"]["vel"] == [0, 0, 0])
    if not isinstance(found, str):
        text = found.csv(int(os.environ.get("DIGITS", "17")))
        found = text + text.splitlines()[-1] + "\n"
    Path("../resources/trajectory/aos_traj.csv").write_text(found)


def togt_folder(folder: Path) -> Path:
    """A folder as TOGT-Planner's checkout with what was built in it."""
    (folder / "build").mkdir(parents=True)
    (folder / "parameters" / "cpc" / "refine").mkdir(parents=True)
    planning = {"piecesPerSegment": 5, "maxThr": 6.879, "boundZ": [0.3, 10000]}
    (folder / "parameters" / "cpc" / "refine" / "cpc_planning.yaml").write_text(yaml.safe_dump(planning))
    program = folder / "build" / "tests"
    program.write_text(
        f"#!{sys.executable}\nimport sys\nsys.path.insert(0, {HERE!r})\nfrom peer_stand_in import togt\ntogt()\n"
    )
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    return folder


def cpc_folder(folder: Path) -> Path:
    """A folder with modules of the names and calls that the CPC planner's example uses."""
    (folder / "src").mkdir(parents=True)
    for name, text in CPC.items():
        head = f"import sys\nsys.path.append({HERE!r})\n"
        (folder / "src" / f"{name}.py").write_text(head + textwrap.dedent(text))
    return folder


CPC = {
    "track": """
        import yaml
        class Track:
            def __init__(self, filename):
                told = yaml.safe_load(open(filename))
                self.places = [told["initial"]["position"], *told["gates"], told["end"]["position"]]
                assert told["initial"]["attitude"] == [1, 0, 0, 0] and "velocity" not in told["end"]
        """,
    "quad": """
        import yaml
        class Quad:
            def __init__(self, filename):
                told = yaml.safe_load(open(filename))
                assert told["thrust_max"] == 6.8794 and told["omega_max_z"] == 0.3 and told["inertia"][2][2] == 0.0017
        """,
    "integrator": "RungeKutta4 = None",
    "planner": """
        from peer_stand_in import answer
        class Planner:
            def __init__(self, quad, track, integrator, options):
                assert options == {"tolerance": 0.3, "nodes_per_gate": 40, "vel_guess": 3.0}
                self.places, self.NPW, self.wp = track.places, 40, track.places[1:]
            def setup(self):
                pass
            def solve(self):
                return answer(self.places, linear=False, rest=False)
        """,
    "trajectory": """
        class Trajectory:
            def __init__(self, x, NPW, wp):
                self.x = x
            def save(self, filename, readable):
                open(filename, "w").write(self.x if isinstance(self.x, str) else self.x.csv(last=False))
        """,
}
