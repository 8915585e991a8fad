"""What is required of a relaxation, whether it regularises, smooths, penalises or steers.

form         rows, bounds and unknowns fit together and use no other symbols; the schedule is not empty
derivatives  rows and costs are once differentiable and finite, with finite second derivatives, for every
             sigma of the schedule, also where G = H = 0
unknowns     guesses of new unknowns are finite and within their bounds
solutions    the homotopy over the plugin's own schedule, with IPOPT, ends within `accuracy` of a local
             minimum; G (and H) >= -1e-4, and min(G, H) within `accuracy` of 0. The problems ask for
             points that are feasible already (the last relaxed set must hold them), for points far from
             any (it must not hold those), with strict complementarity and biactive, for both kinds
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import get_args

import casadi as ca
import numpy as np

from benchbench.conformance.checks.programs import Known, block, unknowns
from benchbench.conformance.checks.require import close, require
from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Block, Mpcc, Pair, PairKind, evaluate, gather
from benchbench.nlp.homotopy import homotopy
from benchbench.nlp.ledger import Ledger
from benchbench.nlp.relaxation import Relaxation, relax
from benchbench.planning.case import Case

KINDS: tuple[PairKind, ...] = get_args(PairKind)
POINTS: dict[PairKind, list[tuple[float, float]]] = {
    "complementarity": [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (0.0, 7.0), (3.0, 0.0), (0.4, 0.3)],
    "vanishing": [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, -1.0), (0.0, -1.0), (0.4, 0.3)],
}


def check_form(relaxation: Relaxation) -> None:
    """Shapes and symbols of what `relax` returns."""
    require(len(relaxation.schedule) > 0, "the schedule is empty")
    require(all(np.isfinite(s) and s >= 0 for s in relaxation.schedule), f"schedule {relaxation.schedule}")
    require(
        set(relaxation.kinds) <= set(KINDS) and "complementarity" in relaxation.kinds,
        f"kinds {relaxation.kinds}",
    )
    require(0 < relaxation.accuracy < 0.1, f"accuracy {relaxation.accuracy}")
    g, h, sigma = (ca.SX.sym(k) for k in ("g", "h", "sigma"))
    for kind in relaxation.kinds:
        seen = relaxation.relax(g, h, sigma, kind, None)
        rows = (seen.rows.shape[0], len(seen.lower), len(seen.upper))
        require(
            len(set(rows)) == 1, f"{kind}: {rows[0]} rows with {rows[1]} lower and {rows[2]} upper bounds"
        )
        require(all(a <= b for a, b in zip(seen.lower, seen.upper, strict=True)), f"{kind}: crossed bounds")
        own = {g, h, sigma, *(u.symbol for u in seen.unknowns), *(s.symbol for s in seen.shared)}
        known = {symbol.element_hash() for symbol in own}
        left = [expression for pair in seen.pairs for expression in pair]
        free = ca.symvar(ca.vertcat(seen.rows, seen.cost, *left))
        strange = [symbol.name() for symbol in free if symbol.element_hash() not in known]
        require(not strange, f"{kind}: rows or cost contain the symbols {strange}, which are no unknowns")


def check_derivatives(relaxation: Relaxation) -> None:
    """First derivatives equal central differences, second ones are finite, at every sigma."""
    for kind in KINDS:
        mpcc = relax(_one_pair(kind), relaxation)
        for part in (*mpcc.constraints, *mpcc.costs):
            for sigma in relaxation.schedule:
                _check_block(part, mpcc, sigma, kind)


def _check_block(part: Block, mpcc: Mpcc, sigma: float, kind: PairKind) -> None:
    z, p, s = part.function.sx_in()
    out = part.function(z, p, s)
    first = ca.Function("first", [z, p, s], [ca.jacobian(out, z)])
    second = ca.Function("second", [z, p, s], [ca.jacobian(ca.vec(ca.jacobian(out, z)), z)])
    for state, numbers in zip(mpcc.guess[gather(part, mpcc.offsets)], part.parameters, strict=True):
        slope = np.asarray(first(state, numbers, sigma))
        where = f"{kind}: {part.name} at sigma = {sigma:g}, unknowns {np.round(state, 3)}"
        require(
            bool(np.all(np.isfinite(np.asarray(part.function(state, numbers, sigma))))), f"value of {where}"
        )
        require(bool(np.all(np.isfinite(slope))), f"gradient of {where} is not finite")
        require(bool(np.all(np.isfinite(np.asarray(second(state, numbers, sigma))))), f"Hessian of {where}")
        step = 1e-3 * min(max(sigma, 1e-6), 1e-3)
        columns = [
            np.asarray(part.function(state + d, numbers, sigma) - part.function(state - d, numbers, sigma))
            / (2 * step)
            for d in step * np.eye(len(state))
        ]
        scale = 1 + np.max(np.abs(slope), initial=0.0)
        close(np.hstack(columns) / scale, slope / scale, 1e-3, f"differences against the gradient of {where}")


def check_unknowns(relaxation: Relaxation) -> None:
    """Guesses of new unknowns."""
    for kind in KINDS:
        for variable in relax(_one_pair(kind), relaxation).variables:
            require(
                bool(np.all(np.isfinite(variable.guess))), f"{kind}: a guess of {variable.name} is not finite"
            )
            inside = (variable.lower <= variable.guess) & (variable.guess <= variable.upper)
            require(bool(np.all(inside)), f"{kind}: a guess of {variable.name} is outside its bounds")


def check_solution(relaxation: Relaxation, problem: Known, case: Case) -> str:
    """The last point of the homotopy against a known solution; `case` gives solver and limits.

    Returns what was measured.
    """
    done = homotopy(problem.mpcc, replace(case, relaxation=relaxation), Ledger(60.0), "conformance")
    distance = problem.distance(done.x)
    negative, unmet = 0.0, 0.0
    for pair, g, h in _values(problem.mpcc, done.x):
        both = pair.kind == "complementarity"
        negative = max(negative, float(np.max(-g)), float(np.max(-h)) if both else 0.0)
        unmet = max(unmet, float(np.max(np.minimum(g, h))))
    text = f"{problem.name}: {distance:.0e} from a minimum, min(G, H) {unmet:.0e}, {done.outcome.detail}"
    require(distance <= relaxation.accuracy, f"{text}; x = {np.round(done.x, 4)}")
    require(negative <= 1e-4, f"{text}; G or H is {-negative:.1e}")
    require(unmet <= relaxation.accuracy, text)
    return text


def _values(mpcc: Mpcc, x: Array) -> Iterator[tuple[Pair, Array, Array]]:
    for pair in mpcc.pairs:
        both = evaluate(pair.block, mpcc, x)
        count = both.shape[1] // 2
        yield pair, both[:, :count], both[:, count:]


def _one_pair(kind: PairKind) -> Mpcc:
    """A pair x, y alone, once for each point."""
    points = np.array(POINTS[kind])
    index = np.arange(points.size).reshape(-1, 2)
    return Mpcc(
        (unknowns(points.ravel()),),
        (),
        (),
        (Pair(block("touch", index, lambda z, p, s: [z[0], z[1]]), kind),),
    )


CHECKS = (check_form, check_derivatives, check_unknowns)
