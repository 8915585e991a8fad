"""Where the parts of a run come from: the run itself, or the folder that it left."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, final

from benchbench.certificate.certificate import Certificate
from benchbench.certificate.certify import certify
from benchbench.certificate.replay import Replay
from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput
from benchbench.ocp.model import Model
from benchbench.ocp.plan import Plan
from benchbench.ocp.scenario import Scenario
from benchbench.planning.case import Case
from benchbench.run import pipeline
from benchbench.run.stored import limits, scene_parts
from benchbench.run.summary import flies
from benchbench.run.view import Source
from benchbench.storage.configuration import PLACES, configuration
from benchbench.storage.files import (
    CONFIG,
    PICTURE,
    PLAN,
    RECORD,
    SOLUTION,
    read_solution,
    vacate,
    write_bytes,
)
from benchbench.storage.playback import Recording, read_mcap
from benchbench.storage.schema import Record

KEPT = (CONFIG, PLAN, PICTURE, SOLUTION, RECORD)
"""Files of a run that go with it; the record last, as it says that the others are there."""


@final
@dataclass(frozen=True)
class Live(Source):
    """A run of this process."""

    done: pipeline.Run
    config: str
    picture: bool

    def plan(self) -> Plan | None:
        """Return it."""
        return self.done.result.planned

    def solution(self) -> dict[str, Array] | None:
        """Return it."""
        result = self.done.result
        return None if isinstance(self.done.case, Case) else result.mpcc.split(result.solved.x)

    def certificate(self) -> Certificate:
        """Return it."""
        return self.done.certificate

    def scene(self) -> tuple[Scenario, Model, Replay | None]:
        """Return it; raises BadInput for what is no flight."""
        case = self.done.case
        if not isinstance(case, Case):
            raise BadInput("draw", f"'{case.names['scenario']}' is no flight", "a run of a flight")
        return case.scenario, case.model, self.done.certificate.flight

    def save(self, folder: Path, table: Path) -> None:
        """Write as the program does."""
        pipeline.write(self.done, folder, table, self.config, self.picture)


@final
@dataclass(frozen=True)
class Stored(Source):
    """A run that left a folder; parts are read when they are asked for."""

    folder: Path
    record: Record

    def plan(self) -> Plan | None:
        """Read it."""
        if not flies(self.record) and not (self.folder / PLAN).exists():
            return None
        return self._recording.plan

    def solution(self) -> dict[str, Array] | None:
        """Read it."""
        if flies(self.record):
            return None
        try:
            return read_solution(self.folder)
        except ValueError as error:
            raise BadInput(str(self.folder), str(error), f"the folder of a run with its {SOLUTION}") from None

    def certificate(self) -> Certificate:
        """Judge the plan again."""
        if (plan := self.plan()) is None:
            raise BadInput("certificate", "of an MPCC is not stored, only its numbers", "run.record")
        scenario, model = scene_parts(self._configuration)
        return certify(plan, scenario, model, limits(self._configuration))

    def scene(self) -> tuple[Scenario, Model, Replay | None]:
        """Read the replay, make the rest from the configuration."""
        return *scene_parts(self._configuration), self._recording.flight

    def save(self, folder: Path, table: Path) -> None:
        """Copy what is there."""
        from benchbench.storage.table import append

        if folder.resolve() != self.folder.resolve():
            vacate(folder)
            for name in KEPT:
                if (self.folder / name).is_file():
                    write_bytes(folder / name, (self.folder / name).read_bytes())
        append(self.record, table)

    @property
    def text(self) -> str:
        """The configuration as it was written, "" where there is none that can be used."""
        files = [self.folder / place for place in PLACES if (self.folder / place).is_file()]
        return files[0].read_text() if files and configuration(self.folder) else ""

    @cached_property
    def _recording(self) -> Recording:
        path = self.folder / PLAN
        if not path.is_file():
            raise BadInput(
                "plan", f"there is no {PLAN} in '{self.folder}'", "the folder of a run that has a plan"
            )
        try:
            return read_mcap(path)
        except (OSError, ValueError) as error:
            raise BadInput(
                str(path), f"is no plan that can be read: {error}", f"the {PLAN} of a run"
            ) from None

    @cached_property
    def _configuration(self) -> dict[str, Any]:
        tree = configuration(self.folder)
        if tree is None:
            problem = f"there is no {CONFIG} that can be read in '{self.folder}'"
            raise BadInput("config", problem, "the folder of a run with its configuration")
        return tree
