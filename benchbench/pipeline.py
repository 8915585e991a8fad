"""The whole run, one line per stage: case -> plan -> certificate -> record -> files. Read this first."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from benchbench.certificate.bound import lower_bound
from benchbench.certificate.certificate import Certificate
from benchbench.certificate.certify import certify, certify_problem
from benchbench.certificate.stationarity import stationarity
from benchbench.mpcc.problem import evaluate
from benchbench.mpcc.residuals import residuals
from benchbench.nlp.ledger import Ledger, Watch
from benchbench.nlp.solver import Claim
from benchbench.ocp.race import Race
from benchbench.planning.case import Case, ReadyCase
from benchbench.planning.result import Answer, Outside, Result
from benchbench.planning.validate import validate
from benchbench.storage import provenance
from benchbench.storage.best_known import BestKnown, packaged
from benchbench.storage.schema import Status, make_record

STATUS: dict[Claim, Status] = {
    "solved": Status.UNCERTIFIED,
    "infeasible": Status.INFEASIBLE,
    "iteration_limit": Status.ITERATION_LIMIT,
    "time_limit": Status.TIME_LIMIT,
}


@dataclass(frozen=True)
class Run:
    """What one run found: the plan and its claimed solution, the judgement, the row of the table."""

    case: Case | ReadyCase
    result: Result | Outside | Answer
    certificate: Certificate
    record: dict[str, Any]


def run(
    case: Case | ReadyCase,
    watch: Watch | None = None,
    labels: Mapping[str, Any] | None = None,
    repeats: int = 1,
    known: BestKnown | None = None,
) -> Run:
    """Plan, judge, record; raises BadInput for a case that cannot work.

    A flight is posed by its strategy; a ready-made MPCC enters at the waist, and there is no plan in its solution.

    labels: ready columns of the record; repeats: solves to time. The plan is always the first solve's; with
    more than one repeat that one is the warm-up and is not among the timed ones; known: best known values to compare
    with, those that come with BenchBench unless said otherwise.
    """
    before = provenance.collect()
    began = time.perf_counter()
    validate(case)
    ledger = Ledger(case.time_limit, watch)
    result = _solve(case, ledger)
    timed = [_again(case, watch) for _ in range(repeats)] if repeats > 1 else [ledger]
    if watch:
        watch.stage("certificate", None)
    judged = time.process_time()
    certificate = _judge(case, result)
    first_order = _first_order(case, result)
    told = _flight(case, result) if isinstance(case, Case) else {}
    judging = ledger.judging_cpu + time.process_time() - judged
    costs = {"certificate_cpu_s": judging, "wall_s": time.perf_counter() - began}
    record = _record(
        case,
        result,
        certificate,
        ledger,
        {**before, **costs, **_spread(timed), **told, **first_order, **(labels or {})},
    )
    if isinstance(case, Case):
        record |= (known or BestKnown.load(packaged())).compare(record)
    return Run(case, result, certificate, record)


def write(done: Run, folder: Path, table: Path, config: str) -> dict[str, Path]:
    """Write record, recording and picture into `folder` and the row into `table`; returns the paths.

    `config` is the composed configuration as YAML. Raises BadInput("output", ...) when the disk refuses.
    """
    from benchbench.storage.files import write_bytes, write_record, write_solution
    from benchbench.storage.table import append

    paths = {"config": folder / "config.yaml"}
    write_bytes(paths["config"], config.encode())
    paths["record"] = write_record(folder, done.record)
    paths["table"] = append(done.record, table).parent
    if isinstance(done.result, Answer):
        return paths | {"solution": write_solution(folder, done.result.mpcc.split(done.result.solved.x))}
    return paths | _write_flight(done, folder, config)


def _write_flight(done: Run, folder: Path, config: str) -> dict[str, Path]:
    from benchbench.report.picture import draw
    from benchbench.storage.files import PLAN
    from benchbench.storage.recording import write_mcap

    paths = {"plan": folder / PLAN, "picture": folder / "plan.png"}
    case, result, flight = done.case, done.result, done.certificate.flight
    assert isinstance(case, Case) and not isinstance(result, Answer)
    plan = result.plan
    write_mcap(paths["plan"], plan, flight, case.scenario, case.model, {"config": config})
    title = (
        f"{case.names['scenario']}, {case.names['dynamics']}, N = {plan.intervals}, {case.names['strategy']}"
    )
    verdict = "certified" if done.certificate.certified else f"NOT certified: {done.certificate.reasons[0]}"
    draw(paths["picture"], plan, case.scenario, case.model, flight, title, verdict)
    return paths


def _solve(case: Case | ReadyCase, ledger: Ledger) -> Result | Outside | Answer:
    if isinstance(case, Case):
        return case.strategy.solve(case, ledger)
    with ledger.building():
        mpcc = case.scenario.mpcc()
    return Answer(mpcc, case.strategy.answer(mpcc, case, ledger))


def _on_the_grid(case: Case, result: Result | Outside) -> bool:
    """Whether the plan is one of ours on the scenario's own grid, and so comparable with others."""
    return isinstance(result, Result) and result.plan.intervals == case.scenario.intervals


def _again(case: Case | ReadyCase, watch: Watch | None) -> Ledger:
    ledger = Ledger(case.time_limit, watch, repeated=True)
    _solve(case, ledger)
    return ledger


def _judge(case: Case | ReadyCase, result: Result | Outside | Answer) -> Certificate:
    if isinstance(case, Case) and isinstance(result, Outside):
        return certify(result.plan, case.scenario, case.model, case.limits)
    assert not isinstance(result, Outside)
    found = residuals(result.mpcc, result.solved.x)
    if isinstance(case, Case) and isinstance(result, Result):
        return certify(result.plan, case.scenario, case.model, case.limits, found)
    return certify_problem(found, case.limits)


def _first_order(case: Case | ReadyCase, result: Result | Outside | Answer) -> dict[str, Any]:
    """Stationarity where it is asked: of a flight it costs more than the whole certificate."""
    asked = case.limits.stationarity
    if isinstance(result, Outside) or asked == "off" or (asked == "auto" and isinstance(case, Case)):
        return {}
    return dict(stationarity(result.mpcc, result.solved.x, case.limits.stationarity_seconds).record())


def _flight(case: Case, result: Result | Outside | Answer) -> dict[str, Any]:
    """What a record says of a flight only."""
    assert not isinstance(result, Answer)
    return {
        "intervals": result.plan.intervals,
        "kappa_init": None if isinstance(case.scenario, Race) else case.scenario.kappa_init,
        "travel_time_s": result.plan.travel_time,
        "lower_bound_s": lower_bound(case.scenario, case.model, case.model.plant()),
        "task_hash": case.task_hash if _on_the_grid(case, result) else None,
    }


def _spread(timed: Sequence[Ledger]) -> dict[str, Any]:
    solves = [ledger.solve_cpu for ledger in timed]
    return {
        "repeats": len(timed),
        "build_cpu_median_s": median(ledger.build_cpu for ledger in timed),
        "solve_cpu_median_s": median(solves),
        "solve_cpu_low_s": min(solves),
        "solve_cpu_high_s": max(solves),
    }


def _record(
    case: Case | ReadyCase,
    result: Result | Outside | Answer,
    certificate: Certificate,
    ledger: Ledger,
    more: Mapping[str, Any],
) -> dict[str, Any]:
    outcome = None if isinstance(result, Outside) else result.solved.outcome
    claim = outcome.claim if outcome else "solved"
    status = Status.CERTIFIED if certificate.certified else STATUS.get(claim, Status.ERROR)
    judged = certificate.record()
    if outcome and outcome.detail and status not in (Status.CERTIFIED, Status.UNCERTIFIED):
        judged["reasons"] = (f"the solver says {outcome.detail}", *certificate.reasons)
    if isinstance(result, Outside):
        judged["advice"] = ""  # it is about our own choices
    return make_record(
        status=status,
        claimed_success=claim == "solved",
        **judged,
        **(_outside(case, result) if isinstance(result, Outside) else _posed(case, result, ledger)),
        seed=case.seed,
        iterations=ledger.iterations,
        evaluations=ledger.evaluations,
        **ledger.costs(),
        peak_memory_mb=provenance.peak_memory_mb(),
        **more,
    )


def _posed(case: Case | ReadyCase, result: Result | Answer, ledger: Ledger) -> dict[str, Any]:
    """What a record says of the problem and of who solved it; a relaxation that met no pairs is not named."""
    mpcc = result.mpcc
    names = {family: name for family, name in case.names.items() if family != "certificate"}
    return {
        **(names if ledger.relaxed else names | {"relaxation": ""}),
        "objective": _objective(result),
        "n_variables": mpcc.size,
        "n_constraints": sum(b.lower.size for b in mpcc.constraints),
        "n_pairs": sum(p.count for p in mpcc.pairs),
        "mpcc_hash": mpcc.digest,
        "solver_version": case.solver.version(),
        **(result.account if isinstance(result, Result) else {}),
    }


def _objective(result: Result | Answer) -> float:
    """The cost; of a ready-made problem without what its relaxation added."""
    if isinstance(result, Result):
        return result.solved.outcome.objective
    mpcc, x = result.mpcc, result.solved.x
    return float(sum(np.sum(evaluate(block, mpcc, x)) for block in mpcc.costs))


def _outside(case: Case | ReadyCase, result: Outside) -> dict[str, Any]:
    """The same of a plan from elsewhere: its planner stands for the solver, our other choices played no part."""
    ours = {family: case.names[family] for family in ("scenario", "vehicle", "strategy")}
    return {**ours, "solver": result.planner}
