"""How large what users ask for may be: checked before memory is spent, far beyond what a plan needs."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

INTERVALS = 20_000
"""Intervals of a grid; an NLP has some twenty unknowns in each."""
GATES = 2_000
"""Gates of a race, and of a lap."""
POINTS = 10_000
"""Points of a path that a target follows: ten minutes of a recording with 16 rows a second."""
TRIES = 100_000
"""Times that a strategy solves."""
TRACK_BYTES, CSV_BYTES, JSON_BYTES = 1_000_000, 10_000_000, 200_000_000
"""Sizes of files: a track, the path of a target, a problem as JSON, unpacked."""

Intervals = Annotated[int, Field(ge=4, le=INTERVALS)]
Nodes = Annotated[int, Field(ge=1, le=INTERVALS)]
Tries = Annotated[int, Field(ge=1, le=TRIES)]
