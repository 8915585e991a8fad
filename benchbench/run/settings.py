"""How runs are carried out: fields of the configuration that do not change what a run computes."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Literal, Self, get_args

from omegaconf import DictConfig

from benchbench.ground.errors import BadInput
from benchbench.storage.provenance import usable_cpus

Rerun = Literal["missing", "failed", "all"]
AUTO: Literal["auto"] = "auto"
_RANGES = {
    "workers": (1, 1024), "repeats": (1, 10_000), "hard_limit": (0.1, 1e9), "memory_limit_mb": (1, 1e9),
}  # fmt: skip
_WHOLE = ("workers", "repeats")


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
        for name, (low, high) in _RANGES.items():
            _check(name, cfg.get(name), low, high)
        if cfg.get("rerun", "missing") not in get_args(Rerun):
            raise BadInput("rerun", f"{cfg.get('rerun')!r} was given", ", ".join(get_args(Rerun)))
        picture = cfg.get("picture", AUTO)
        if not isinstance(picture, bool) and picture != AUTO:
            raise BadInput("picture", f"{picture!r} was given", "true, false or auto")
        repeats = cfg.get("repeats") or 1
        return cls(
            workers=cfg.get("workers") or usable_cpus() or 1,
            rerun=cfg.get("rerun", "missing"),
            picture=picture,
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


def _check(name: str, value: object, low: float, high: float) -> None:
    kinds = (int,) if name in _WHOLE else (int, float)
    fits = isinstance(value, kinds) and not isinstance(value, bool) and math.isfinite(value)
    if value is not None and not (fits and low <= value <= high):  # type: ignore[operator]
        kind = "whole number" if name in _WHOLE else "number"
        raise BadInput(name, f"{value!r} was given", f"a {kind} from {low:g} to {high:g}, or null")
