"""Numbers of one channel of a recording, read back."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput, Unavailable


def read_series(path: Path, topic: str, names: Sequence[str]) -> Array:
    """Return rows (n, 1 + names): time s, then what the channel says under these names.

    Raises BadInput for what is no such recording, Unavailable without the package mcap.
    """
    try:
        from mcap.reader import make_reader
    except ImportError:
        raise Unavailable(
            "reading a recording: mcap is not installed; pip install 'benchbench[report]'"
        ) from None
    try:
        with path.open("rb") as file:
            told = [json.loads(one.data) for _, _, one in make_reader(file).iter_messages(topics=[topic])]
        rows = np.array([[row["time"], *(row[name] for name in names)] for row in told], float)
    except Exception as error:  # noqa: BLE001  # the readers of a broken file fail in many ways
        raise BadInput(str(path), f"cannot be read: {error}", "the flight.mcap of a run") from None
    if len(rows) < 2:
        raise BadInput(str(path), f"says nothing of {topic}", "the flight.mcap of a run")
    return rows
