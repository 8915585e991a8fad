"""Interface of an external planner, and how it is run: a child process in a folder of its own, with a wall limit."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import tempfile
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import singledispatch
from pathlib import Path
from typing import ClassVar, Literal

from benchbench.ground.errors import BadInput, Crash, IncompatibleCase, NoPlan, Timeout, Unavailable
from benchbench.ocp.model import Model
from benchbench.ocp.plan import Plan
from benchbench.ocp.race import Race
from benchbench.ocp.scenario import Scenario
from benchbench.planning.case import Case
from benchbench.planning.motors import order_of, reordered
from benchbench.storage.flight_csv import read_csv
from benchbench.storage.multirotor import plan_of

LOG = "peer.log"


@dataclass(frozen=True)
class Racer:
    """A quadrotor as planners of races describe it; SI units, see the model `quadrotor`."""

    mass: float
    inertia: tuple[float, float, float]
    lever: float
    torque_coefficient: float
    motor_force: tuple[float, float]
    body_rate: tuple[float, float, float]
    gravity: float


@dataclass(frozen=True)
class Call:
    """A command to run in a folder, the CSV file it is to write, and how its inputs run between the rows.

    tidy: what to do with the text of that file before it is read; motors: how it numbers them.
    """

    command: Sequence[str]
    folder: Path
    result: Path
    interpolation: Literal["hold", "linear"]
    tidy: Callable[[str], str] | None = None
    motors: str = "ours"


class Peer(ABC):
    """An external planner; nothing of it is ours but how to ask it and to read its answer."""

    name: ClassVar[str]

    @abstractmethod
    def missing(self) -> str:
        """Say what is needed and not there, "" if it can be run."""

    @abstractmethod
    def call(self, race: Race, racer: Racer, work: Path) -> Call:
        """Write its input files below `work`, never into its own folder; raises IncompatibleCase."""


def ask(peer: Peer, case: Case, seconds: float) -> Plan:
    """Run a planner on a case and return its plan.

    Raises Unavailable, IncompatibleCase, Timeout, Crash, or NoPlan when what it wrote is no plan.
    """
    if reason := peer.missing():
        raise Unavailable(f"peer '{peer.name}': {reason}")
    race = raced(case.scenario, peer.name)
    with tempfile.TemporaryDirectory(prefix="benchbench-peer-") as folder:
        call = peer.call(race, racer(case.model), Path(folder))
        _run(peer.name, call, seconds)
        if not call.result.is_file():
            raise NoPlan(f"peer '{peer.name}' wrote no plan; it says: {_said(call)}")
        if call.tidy:
            call.result.write_text(call.tidy(call.result.read_text(errors="replace")))
        try:
            plan = plan_of(read_csv(call.result), case.model, call.interpolation)
            return reordered(plan, order_of(call.motors, case.model))
        except BadInput as error:
            problem = str(error).replace(str(call.result), call.result.name)
            raise NoPlan(f"peer '{peer.name}' wrote what is no plan: {problem}") from None


@singledispatch
def raced(scenario: Scenario, peer: str) -> Race:
    """Return the scenario as the race that a peer can be asked for; raises IncompatibleCase where it is none."""
    raise IncompatibleCase("peer", f"'{peer}' plans races only", "+scenario=race")


@raced.register
def _(scenario: Race, peer: str) -> Race:
    return scenario


def racer(model: Model) -> Racer:
    """Read the numbers of a quadrotor; raises IncompatibleCase for another vehicle, or limits that change on the way."""
    try:
        numbers = {name: getattr(model, name) for name in Racer.__dataclass_fields__}
    except AttributeError as error:
        problem = f"'{model.name}' has no {error.name}, which peers need"
        raise IncompatibleCase("vehicle", problem, "race_quadrotor") from None
    if getattr(model, "ramp", None) is not None:
        raise IncompatibleCase("vehicle", "peers are asked with flat limits only", "race_quadrotor")
    return Racer(**numbers)


def balls(race: Race, peer: str) -> None:
    """Raise IncompatibleCase for gates that are no plain balls, which is all that peers are asked to fly through."""
    for number, gate in enumerate(race.goals, 1):
        if gate.opening is not None or gate.speed is not None or gate.heading is not None:
            problem = f"'{peer}' is asked for balls only, but gate {number} is more"
            raise IncompatibleCase("scenario.track", problem, "gates with a radius")


def _run(name: str, call: Call, seconds: float) -> None:
    """Run the command; its whole process group is killed at the wall limit, or when we are interrupted."""
    environment = {**os.environ, "MPLBACKEND": "Agg"}
    with (call.folder / LOG).open("wb") as log:
        child = subprocess.Popen(
            call.command, cwd=call.folder, env=environment, stdin=subprocess.DEVNULL, stdout=log,
            stderr=subprocess.STDOUT, start_new_session=True,
        )  # fmt: skip
        try:
            code = child.wait(seconds)
        except subprocess.TimeoutExpired:
            raise Timeout(f"peer '{name}' did not end within {seconds:.3g} s and was killed") from None
        finally:
            _end(child)
    if code < 0:
        raise Crash(f"peer '{name}' died of {signal.Signals(-code).name}; it says: {_said(call)}")
    if code > 0:
        raise Crash(f"peer '{name}' ended with exit code {code}; it says: {_said(call)}")


def _end(child: subprocess.Popen[bytes]) -> None:
    """Kill what is left of the child's process group."""
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(child.pid, signal.SIGKILL)
    child.wait()


def _said(call: Call) -> str:
    """Last line of its output."""
    lines = (call.folder / LOG).read_text(errors="replace").strip().splitlines()
    return lines[-1][:200] if lines else "nothing"
