"""Does the solution solve the MPCC as it was posed, not as it was relaxed?"""

from __future__ import annotations

import math

from benchbench.certificate import advice
from benchbench.certificate.check import Check, Checks, at_most
from benchbench.certificate.limits import ProblemLimits
from benchbench.mpcc.residuals import Residuals


def original_problem(found: Residuals, limits: ProblemLimits) -> Checks:
    """Check the residuals of the MPCC that is said to be solved."""
    number = math.isfinite(found.cost)
    reason = "" if number else f"the cost at this point is {found.cost:g}, which is no finite number"
    yield Check("finite_cost", found.cost, 0.0, "1", number, reason, advice.SOLVE)
    what = f"violation of the original problem (worst in '{found.worst_constraint}')"
    yield at_most("residual", what, found.max_violation, limits.residual, "1", advice=advice.SOLVE)
    if limits.complementarity is not None:
        what = "violation of the complementarity pairs"
        yield at_most(
            "complementarity",
            what,
            found.max_complementarity,
            limits.complementarity,
            "1",
            advice=advice.SHARPEN,
        )
    what = "violation of the signs of the complementarity pairs"
    yield at_most(
        "complementarity_sign", what, found.max_negativity, limits.residual, "1", advice=advice.SHARPEN
    )
    if limits.product is not None:
        what = "product of a complementarity pair"
        yield at_most(
            "complementarity_product", what, found.max_product, limits.product, "1", advice=advice.SHARPEN
        )
