"""Reads the path of a target: rows t,x,y,z of a CSV file."""

from __future__ import annotations

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput
from benchbench.ocp.sizes import POINTS

FIELD = "scenario.target.csv"


def read(data: bytes) -> Array:
    """Return the rows (n, 4) of a CSV file with the header t,x,y,z (s, m); raises BadInput when it is malformed."""
    try:
        header, *lines = data.decode("utf-8-sig").splitlines() or [""]
        if [name.strip() for name in header.split(",")] != ["t", "x", "y", "z"]:
            raise BadInput(FIELD, f"has the header '{header[:40]}'", "t,x,y,z")
        table = np.loadtxt(lines, delimiter=",", ndmin=2) if lines else np.zeros((0, 4))
    except ValueError as error:
        raise BadInput(FIELD, str(error), "numbers in four columns t,x,y,z") from None
    if table.shape[1] != 4 or len(table) < 3 or not np.all(np.isfinite(table)):
        raise BadInput(FIELD, f"has shape {table.shape}", "at least 3 rows of finite t,x,y,z")
    if len(table) > POINTS:
        raise BadInput(FIELD, f"has {len(table)} rows", f"at most {POINTS}")
    if np.any(np.diff(table[:, 0]) <= 0):
        raise BadInput(FIELD, "times do not increase", "strictly increasing t")
    return table
