"""What limits cost: first-order change of a solved problem's cost with its bounds, read off their multipliers."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ocp.model import Coordinates
from benchbench.ocp.scenario import Scenario
from benchbench.planning.result import Result

RATES = "v"
"""Name of the nodal velocities among the unknowns."""


def prices(result: Result, kind: str) -> Array | None:
    """Return by how much the cost would fall if the bounds of each column of some unknowns were eased by all of their size, (n,).

    None where the problem has no such unknowns or the solver tells no multipliers. Bounds that fix an unknown have no price.
    """
    point, mpcc = result.solved.outcome.point, result.mpcc
    ends = np.cumsum([0, *(v.size for v in mpcc.variables)])
    found = [(v, a) for v, a in zip(mpcc.variables, ends, strict=False) if v.name == kind]
    if point.lam_x is None or not found:
        return None
    variable, first = found[0]
    shape = variable.guess.shape
    price = np.abs(point.lam_x[first : first + variable.size]).reshape(shape)
    value = result.solved.values[kind].reshape(shape)
    upper = np.abs(variable.upper - value) <= np.abs(value - variable.lower)
    bound = np.where(upper, variable.upper, variable.lower)
    priced = (variable.lower < variable.upper) & np.isfinite(bound)
    return np.asarray((price * np.abs(np.where(priced, bound, 0.0))).sum(axis=0))


def of_rates(result: Result, velocity: Coordinates) -> Mapping[str, float]:
    """Share of the cost that a margin of all of a rate's limit would take, by the rate's name; to first order, so for small margins."""
    found = prices(result, RATES)
    if found is None or len(found) != len(velocity.names) or not result.objective > 0:
        return {}
    return dict(zip(velocity.names, (found / result.objective).tolist(), strict=True))


def of_rows(result: Result) -> Mapping[str, float]:
    """By how much the cost would fall if all rows of a block were eased by their scale, by the block's name; nothing without multipliers."""
    multipliers, blocks = result.solved.outcome.point.lam_g, result.mpcc.constraints
    ends = np.cumsum([0, *(block.lower.size for block in blocks)])
    if multipliers is None or len(multipliers) != ends[-1]:
        return {}
    return {
        block.name: float(np.abs(multipliers[first:last]).sum())
        for block, first, last in zip(blocks, ends, ends[1:], strict=False)
    }


def of_paths(result: Result, scenario: Scenario) -> Mapping[str, float]:
    """Share of the cost that a margin of all of its limit would take, by the name of a contact's condition that is kept along the path.

    Of all stops together; to first order of h = (gap / limit)^2 - 1, which is twice that of gap / limit - 1.
    """
    rows = of_rows(result) if result.objective > 0 else {}
    found: dict[str, float] = {}
    for stop in scenario.itinerary.stops:
        for name, contact in stop.contacts.items():
            if contact.kept != "in contact" and (block := f"{stop.prefix}{name}") in rows:
                found[name] = found.get(name, 0.0) + 2 * rows[block] / result.objective
    return found
