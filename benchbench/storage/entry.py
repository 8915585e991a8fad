"""One message of a recording, before it is written."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from benchbench.ground.arrays import Array


@dataclass(frozen=True)
class LogEntry:
    """A message for a Foxglove channel at a log time in ns."""

    log_time: int
    channel: Any
    message: Any


def nanoseconds(times: Array) -> list[int]:
    """Log times in ns of plan times in s."""
    return [int(ns) for ns in np.rint(np.asarray(times) * 1e9)]
