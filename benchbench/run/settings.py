"""How runs are carried out: fields of the configuration that do not change what a run computes."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Literal, Self

from omegaconf import DictConfig

from benchbench.run.numbers import AUTO, Rerun, check_execution
from benchbench.storage.provenance import usable_cpus


@dataclass(frozen=True)
class Settings:
    """The fields of conf/config.yaml of the same names, with their defaults filled in."""

    workers: int
    rerun: Rerun
    picture: bool | Literal["auto"]
    """Whether the plan is drawn; "auto": by a single run, see `draws`."""
    repeats: int
    """Solves whose times are recorded; 1 is the one that gives the plan."""
    hard_limit: float
    """Wall seconds after which a run is killed; null, a single run has no such limit."""
    memory_limit_mb: float | None
    """Private memory that a run may use, in MB (10^6 bytes)."""

    @classmethod
    def of(cls, cfg: DictConfig) -> Self:
        """Read and check them; raises BadInput."""
        check_execution(cfg)
        repeats = cfg.get("repeats") or 1
        return cls(
            workers=cfg.get("workers") or usable_cpus() or 1,
            rerun=cfg.get("rerun", "missing"),
            picture=cfg.get("picture", AUTO),
            repeats=repeats,
            hard_limit=cfg.get("hard_limit") or (2.0 + repeats) * cfg.time_limit + 60.0,
            memory_limit_mb=cfg.get("memory_limit_mb"),
        )

    def draws(self, sweep: bool) -> bool:
        """Whether a run draws its plan; one of a sweep only if it is told to, as `benchbench draw` does it later."""
        return self.picture is True or (self.picture == AUTO and not sweep)


NAMES = tuple(field.name for field in fields(Settings))
NOT_DECISIVE = ("output", "on_step", *NAMES)
"""Fields of the configuration that do not change what a run computes; its hash leaves them out."""
