"""The ledger of claims: what the paper says, what checks it, what came out. `references/paper_claims.yaml` is the only source."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import yaml  # type: ignore[import-untyped]
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from benchbench.ground.errors import BadInput, invalid
from benchbench.storage.best_known import packaged

FILE = "paper_claims.yaml"
HEAD = ("claim", "command", "what came out", "verdict")


class Claim(BaseModel):
    """One claim.

    source    section of the paper
    commands  what checks it, each as it is typed
    value     what came out, with units
    note      in what sense the verdict holds, "" for in every one
    page      where in docs more of it stands, "" for nowhere
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    source: str
    claim: str
    commands: tuple[str, ...] = Field(min_length=1)
    value: str
    verdict: Literal["reproduced", "partly", "not reproduced"]
    note: str = ""
    page: str = ""


def load(path: Path | None = None) -> tuple[Claim, ...]:
    """Read the ledger that comes with BenchBench, or another one; raises BadInput for a file that is none."""
    path = path or packaged(FILE)
    try:
        return tuple(TypeAdapter(list[Claim]).validate_python(yaml.safe_load(path.read_text("utf-8"))))
    except ValidationError as error:
        raise invalid(str(path), error, Claim.model_fields) from None
    except (OSError, yaml.YAMLError) as error:
        raise BadInput(
            str(path), f"cannot be read: {str(error).splitlines()[0]}", "a list of claims"
        ) from None


def markdown(claims: Sequence[Claim]) -> str:
    """Return the table of docs/paper_claims.md."""
    lines = [HEAD, ("---",) * len(HEAD), *map(_row, claims)]
    return "".join(f"| {' | '.join(cells)} |\n" for cells in lines).replace(
        "| --- | --- | --- | --- |", "|---|---|---|---|"
    )


def _row(one: Claim) -> tuple[str, ...]:
    commands = ", ".join(f"`{command}`" for command in one.commands)
    more = f" ([{one.page}]({one.page}))" if one.page else ""
    return f"{one.source}: {one.claim}", commands + more, one.value, said(one)


def said(one: Claim) -> str:
    """The verdict with its note."""
    return f"{one.verdict}: {one.note}" if one.note else one.verdict
