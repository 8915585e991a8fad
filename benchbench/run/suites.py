"""Suites: named, versioned sweeps over the seeds of a family of tasks, or over several scenarios, one YAML file each in `conf/suite`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Self

from omegaconf import OmegaConf
from omegaconf.errors import OmegaConfBaseException
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError, model_validator
from yaml import YAMLError  # type: ignore[import-untyped]

from benchbench.ground.errors import BadInput, invalid, unknown_choice
from benchbench.run import config
from benchbench.run.overrides import keys

GROUP = "suite"
QUICK = 10
"""A quick suite has one of so many tasks."""


def _increasing(pair: tuple[int, int]) -> tuple[int, int]:
    if not pair[0] <= pair[1]:
        raise ValueError("the first seed must not exceed the last")
    return pair


Seed = Annotated[int, Field(ge=0)]


class Suite(BaseModel):
    """What a suite's file says.

    title     one line
    version   of its tasks: other tasks are another version
    scenario  the family, or a list of scenarios
    seeds     first and last, of a family
    fixed     overrides of every run
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    title: str
    version: Annotated[int, Field(ge=1)]
    scenario: str | Annotated[tuple[str, ...], Field(min_length=1)]
    seeds: Annotated[tuple[Seed, Seed], AfterValidator(_increasing)] | None = None
    fixed: tuple[str, ...] = ()

    @model_validator(mode="after")
    def _seeded(self) -> Self:
        if (self.seeds is None) == isinstance(self.scenario, str):
            raise ValueError("seeds belong to a family, which is one scenario; a list of scenarios has none")
        return self

    def count(self, quick: bool) -> int:
        """Return how many tasks there are; quick: a tenth of them, one at least."""
        whole = len(self.scenario) if self.seeds is None else self.seeds[1] - self.seeds[0] + 1
        return max(1, whole // QUICK) if quick else whole

    def overrides(self, more: Sequence[str], quick: bool = False) -> list[str]:
        """Return the overrides of the sweep; `more` are the user's, which win over the fixed ones.

        Raises BadInput for one that asks for other tasks than the suite has, and what Hydra does for what is none.
        """
        asked = keys(more)
        for key in ("scenario", "seed", "scenario.family.seed"):
            if key in asked:
                one = self.scenario if isinstance(self.scenario, str) else self.scenario[0]
                raise BadInput(key, "is what a suite says", f"a sweep, -m +scenario={one} {key}=...")
        fixed = [text for text in self.fixed if not keys([text]) & asked]
        return [*self._tasks(quick), *fixed, *more]

    def _tasks(self, quick: bool) -> list[str]:
        count = self.count(quick)
        if self.seeds is None:
            return [f"+scenario={','.join(self.scenario[:count])}"]
        return [f"+scenario={self.scenario}", f"seed=range({self.seeds[0]},{self.seeds[0] + count})"]


def suites(own: str | None = None) -> dict[str, Path]:
    """Return the files of all suites by name; own: a folder as given with --config-dir, whose suites win."""
    places = [Path(config.folder()), *([Path(own)] if own else [])]
    return {file.stem: file for place in places for file in sorted((place / GROUP).glob("*.yaml"))}


def suite(name: str, own: str | None = None) -> tuple[str, Suite]:
    """Return the name and the content of a suite, given by name or as the path of a YAML file. Raises BadInput."""
    found = suites(own)
    path = Path(name) if name.endswith((".yaml", ".yml")) else found.get(name)
    if path is None:
        raise unknown_choice(GROUP, name, found)
    try:
        told: Any = OmegaConf.to_container(OmegaConf.load(path))
    except OSError as error:
        raise BadInput(str(path), f"cannot be read: {error.strerror}", "a YAML file with a suite") from None
    except (YAMLError, OmegaConfBaseException, ValueError) as error:
        raise BadInput(str(path), f"is no YAML: {str(error).splitlines()[0]}") from None
    if not isinstance(told, Mapping):
        raise BadInput(str(path), "is no suite", ", ".join(Suite.model_fields))
    try:
        return path.stem, Suite(**{str(key): value for key, value in told.items()})
    except ValidationError as error:
        raise invalid(str(path), error, Suite.model_fields) from None
