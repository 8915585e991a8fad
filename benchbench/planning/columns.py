"""What the record says of a run, from what planning gave and the certificate judged."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from statistics import median
from typing import Any

import numpy as np

from benchbench.certificate.certificate import Certificate
from benchbench.mpcc.problem import evaluate
from benchbench.nlp.ledger import Ledger
from benchbench.nlp.reference import Reference
from benchbench.nlp.solver import Claim
from benchbench.planning.case import AnyCase
from benchbench.planning.result import Result, Solution
from benchbench.storage import provenance
from benchbench.storage.schema import Record, Status, make_record

STATUS: dict[Claim, Status] = {
    "solved": Status.UNCERTIFIED,
    "infeasible": Status.INFEASIBLE,
    "iteration_limit": Status.ITERATION_LIMIT,
    "time_limit": Status.TIME_LIMIT,
}


def record(
    case: AnyCase, result: Result, certificate: Certificate, ledger: Ledger, more: Mapping[str, Any]
) -> Record:
    """Return the record of a run; `more`: columns that are ready."""
    told = _elsewhere(case, result) if result.posed is None else _posed(case, result, result.posed, ledger)
    return make_record(
        **{**_verdict(result, certificate), **told, **result.account},
        seed=case.seed,
        iterations=ledger.iterations,
        evaluations=ledger.evaluations,
        **ledger.costs(),
        peak_memory_mb=provenance.peak_memory_mb(),
        **more,
    )


def first_order(case: AnyCase, result: Result) -> dict[str, Any]:
    """Stationarity where it is asked: of a flight it costs more than the whole certificate."""
    asked, seconds = case.limits.stationarity, case.limits.stationarity_seconds
    if result.posed is None or asked == "off" or (asked == "auto" and result.planned is not None):
        return {}
    from benchbench.certificate.stationarity import stationarity  # scipy takes half a second to import

    return dict(stationarity(result.mpcc, result.solved.x, seconds).record())


def spread(timed: Sequence[Ledger]) -> dict[str, Any]:
    """CPU times over the solves that were timed."""
    solves = [ledger.solve_cpu for ledger in timed]
    return {
        "repeats": len(timed),
        "build_cpu_median_s": median(ledger.build_cpu for ledger in timed),
        "solve_cpu_median_s": median(solves),
        "solve_cpu_low_s": min(solves),
        "solve_cpu_high_s": max(solves),
        "reference_cpu_s": Reference().cpu_s() if len(timed) > 1 else None,
    }


def _verdict(result: Result, certificate: Certificate) -> dict[str, Any]:
    """How the run ended; a plan from elsewhere is claimed, and advice about our own choices would not help it."""
    judged = certificate.record()
    if result.posed is None:
        status = Status.CERTIFIED if certificate.certified else Status.UNCERTIFIED
        return judged | {"status": status, "claimed_success": True, "advice": ""}
    outcome = result.solved.outcome
    status = Status.CERTIFIED if certificate.certified else STATUS.get(outcome.claim, Status.ERROR)
    if outcome.detail and status not in (Status.CERTIFIED, Status.UNCERTIFIED):
        judged["reasons"] = (f"the solver says {outcome.detail}", *certificate.reasons)
    return judged | {"status": status, "claimed_success": result.claimed}


def _posed(case: AnyCase, result: Result, solution: Solution, ledger: Ledger) -> dict[str, Any]:
    """The problem and who solved it; a relaxation that met no pairs is not named."""
    mpcc = solution.mpcc
    names = {family: name for family, name in case.names.items() if family != "certificate"}
    return {
        **(names if ledger.relaxed else names | {"relaxation": ""}),
        "objective": _own_cost(solution) if result.planned is None else solution.solved.outcome.objective,
        "n_variables": mpcc.size,
        "n_constraints": sum(b.lower.size for b in mpcc.constraints),
        "n_pairs": sum(p.count for p in mpcc.pairs),
        "mpcc_hash": mpcc.digest,
        "solver_version": case.solver.version(),
    }


def _own_cost(solution: Solution) -> float:
    """The cost of a ready-made problem, without what its relaxation added."""
    mpcc, x = solution.mpcc, solution.solved.x
    return float(sum(np.sum(evaluate(block, mpcc, x)) for block in mpcc.costs))


def _elsewhere(case: AnyCase, result: Result) -> dict[str, Any]:
    """The same of a plan from elsewhere: its planner stands for the solver, our other choices played no part."""
    ours = {family: case.names[family] for family in ("scenario", "vehicle", "strategy")}
    return {**ours, "solver": result.planner}
