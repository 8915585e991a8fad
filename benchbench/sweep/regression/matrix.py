"""What is run and how much worse is worse: `matrix.yaml` of the baseline folder."""

from __future__ import annotations

from dataclasses import field
from pathlib import Path
from typing import Annotated

from omegaconf import OmegaConf
from omegaconf.errors import OmegaConfBaseException
from pydantic import ConfigDict, Field, TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass
from yaml import YAMLError  # type: ignore[import-untyped]

from benchbench.ground.errors import BadInput

MATRIX = "matrix.yaml"
_STRICT = ConfigDict(extra="forbid")
Share = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]


@dataclass(frozen=True, config=_STRICT)
class Gates:
    """Tolerances: how far above the baseline a number may be, as a share of it.

    `tracking` is that on the errors of flights, whose successes are counted exactly. Fewer iterations or a shorter travel time are never a
    regression. `solve_factor` is the factor on the ratio
    of solve time to reference time that must be exceeded with `confidence`.
    """

    travel_time: Share = 0.005
    objective: Share = 0.005
    iterations: Share = 0.3
    evaluations: Share = 0.3
    tracking: Share = 0.1
    solve_factor: Annotated[float, Field(gt=1.0, allow_inf_nan=False)] = 1.5
    confidence: Annotated[float, Field(gt=0.5, lt=1.0)] = 0.99


@dataclass(frozen=True, config=_STRICT)
class Matrix:
    """Cases by name, each a list of overrides of the main command; `common` ones come first. Those with `flights` are flown."""

    cases: Annotated[dict[str, list[str]], Field(min_length=1)]
    common: list[str] = field(default_factory=list)
    repeats: Annotated[int, Field(ge=5)] = 7
    """Timed solves of each case; fewer than five cannot reach a confidence of 0.99."""
    gates: Gates = field(default_factory=Gates)

    @classmethod
    def load(cls, folder: Path) -> Matrix:
        """Read it; raises BadInput."""
        path = folder / MATRIX
        try:
            return TypeAdapter(cls).validate_python(OmegaConf.to_container(OmegaConf.load(path)))
        except OSError as error:
            raise BadInput("--baseline", f"'{path}': {error.strerror}", f"a folder with a {MATRIX}") from None
        except (YAMLError, OmegaConfBaseException, UnicodeDecodeError) as error:
            raise BadInput(str(path), f"is no YAML: {error}") from None
        except ValidationError as error:
            first = error.errors()[0]
            where = ".".join(map(str, first["loc"]))
            raise BadInput(f"{path}: {where}", first["msg"]) from None
