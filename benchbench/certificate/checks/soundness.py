"""Are there numbers at all, and does time go on? Without that nothing else can be asked."""

from __future__ import annotations

import numpy as np

from benchbench.certificate import advice
from benchbench.certificate.check import Check, Checks
from benchbench.ocp.plan import Plan


def finite(plan: Plan) -> Checks:
    """Check for finite numbers."""
    for name in ("time", "configuration", "velocity", "inputs", "progress"):
        bad = ~np.isfinite(getattr(plan, name))
        row = int(np.argmax(bad.reshape(len(bad), -1).any(axis=1)))
        reason = f"the plan's {name} is not a number in row {row}" if bad.any() else ""
        yield Check(f"finite_{name}", float(bad.sum()), 0.0, "1", not bad.any(), reason, advice.RESTART)


def increasing(plan: Plan) -> Checks:
    """Check that time starts at 0 and increases."""
    shortest = float(np.min(np.diff(plan.time)))
    ok = shortest > 0 and plan.time[0] == 0
    reason = f"time must start at 0 and increase, but its smallest step is {shortest:.6g} s"
    yield Check("time", shortest, 0.0, "s", ok, "" if ok else reason, advice.RESTART)
