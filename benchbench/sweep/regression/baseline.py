"""The stored baseline: what each case gave, and where and with what that was measured."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

from pydantic import Discriminator, Field, FiniteFloat, Tag, TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass

from benchbench.ground.errors import BadInput
from benchbench.storage import provenance
from benchbench.storage.files import write_bytes
from benchbench.sweep.regression.measure import Measured

BASELINE = "baseline.json"
TIMED, FLOWN = "timed", "flown"


@dataclass(frozen=True)
class _Measured:
    status: str
    certified: bool
    travel_time_s: FiniteFloat | None
    objective: FiniteFloat | None
    iterations: int | None
    evaluations: int | None
    ratios: Annotated[list[Annotated[FiniteFloat, Field(gt=0.0)]], Field(min_length=5)]


@dataclass(frozen=True)
class _Flown:
    flights: Annotated[int, Field(gt=0)]
    flights_succeeded: int
    flight_error_before_m: FiniteFloat | None
    flight_error_after_m: FiniteFloat | None


def _kind(entry: Any) -> str:
    return FLOWN if isinstance(entry, Mapping) and "flights" in entry else TIMED


@dataclass(frozen=True)
class _Baseline:
    provenance: dict[str, Any]
    cases: dict[
        str, Annotated[Annotated[_Measured, Tag(TIMED)] | Annotated[_Flown, Tag(FLOWN)], Discriminator(_kind)]
    ]


def save(folder: Path, entries: Mapping[str, Measured]) -> Path:
    """Write the baseline with its provenance; raises BadInput when the disk refuses."""
    content = {"provenance": provenance.collect(), "cases": dict(entries)}
    path = folder / BASELINE
    write_bytes(path, (json.dumps(content, indent=1) + "\n").encode())
    return path


def load(folder: Path) -> tuple[dict[str, Any], dict[str, Measured]]:
    """Return provenance and entries by case; raises BadInput."""
    path = folder / BASELINE
    try:
        content = json.loads(path.read_text())
        TypeAdapter(_Baseline).validate_python(content)
    except OSError as error:
        raise BadInput("--baseline", f"'{path}': {error.strerror}", "--update makes it") from None
    except ValidationError as error:
        first = error.errors()[0]
        raise BadInput(
            f"{path}: {'.'.join(str(part) for part in first['loc'] if part not in (TIMED, FLOWN))}",
            first["msg"],
        ) from None
    except ValueError as error:
        raise BadInput(str(path), f"is no JSON: {error}", "--update makes it again") from None
    return content["provenance"], content["cases"]
