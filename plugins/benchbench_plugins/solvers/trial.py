"""Tries a CasADi plugin that may be missing, without endangering this process."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import Any

from benchbench.ground.errors import Unavailable
from benchbench.nlp.availability import ask


def require(plugin: str, options: Mapping[str, Any], remedy: str) -> None:
    """Raise Unavailable with reason and remedy unless a tiny problem can be solved with these options."""
    question = json.dumps({"plugin": plugin, "options": options}, sort_keys=True)
    answer = ask(__name__, question)
    if not answer.works:
        raise Unavailable(f"{plugin}: {answer.reason}; remedy: {remedy}")


def fault(question: str) -> str:
    """Return why {"plugin": ..., "options": ...} (JSON) does not work, "" if it does."""
    import casadi as ca

    from benchbench_plugins.solvers.output import last_line, quiet

    asked = json.loads(question)
    x = ca.MX.sym("x", 2)
    problem = {"x": x, "f": ca.sumsqr(x - 1), "g": x[0] + x[1]}
    with quiet() as text:
        try:
            solver = ca.nlpsol(
                "trial", asked["plugin"], problem, {"error_on_fail": False, **asked["options"]}
            )
            found = float(solver(x0=[0.5, 0.5], lbg=0, ubg=1)["f"])
            status = str(solver.stats().get("return_status", ""))
        except RuntimeError as error:
            missing = re.search(r"(?:Error code: )+(.*)", text.getvalue())
            return missing[1] if missing else last_line(error)
    return "" if abs(found - 0.5) < 1e-4 else f"it did not solve a tiny problem ({status or 'no status'})"
