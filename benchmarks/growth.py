"""How build and solve grow with N, and against the same problem without blocks: `python benchmarks/growth.py [SCENARIO]`.

The problem of the first table is `strategy=phases` of a scenario. `blocks` are ours; `one SX graph` is the same Mpcc expanded instance by
instance, `plain MX` the same blocks without their own derivatives: both leave all derivatives to CasADi. Same IPOPT
options, same start. CPU seconds of this process, one run each, in one run of this program; read the ratios. The second
table is about whole strategies, judged.
"""

from __future__ import annotations

import os

os.environ["OMP_NUM_THREADS"] = "1"

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np

from benchbench.formulation.handover import phases
from benchbench.mpcc.problem import Block, Mpcc, gather
from benchbench.nlp.ledger import Ledger
from benchbench.nlp.program import assemble
from benchbench.nlp.solver import Point, Setup
from benchbench.planning.case import Case
from benchbench.planning.guess import straight_line
from benchbench.planning.strategy import judge, planned
from benchbench.run import config

SIZES = (25, 50, 100, 200, 400)
OPTIONS = {"print_time": False, "calc_lam_p": False, "error_on_fail": False}


@dataclass(frozen=True)
class Cost:
    """CPU seconds to build and to solve, iterations, and what was found."""

    build: float
    solve: float
    iterations: int
    objective: float

    @property
    def each(self) -> float:
        """Seconds per iteration."""
        return self.solve / max(self.iterations, 1)


def blocks(mode: str) -> Callable[[Case], Cost]:
    """Ours; `mode` is compile=."""

    def run(case: Case) -> Cost:
        began = time.process_time()
        mpcc = phases(case, straight_line(case)).mpcc
        solve = case.solver.prepare(mpcc, Setup(compile=mode))  # type: ignore[arg-type]
        built = time.process_time()
        outcome = solve(0.0, Point(mpcc.guess))
        return Cost(built - began, outcome.cpu_s, outcome.iterations, outcome.objective)

    return run


def one_graph(case: Case) -> Cost:
    """The whole problem as one unrolled SX graph."""
    began = time.process_time()
    mpcc = phases(case, straight_line(case)).mpcc
    x = ca.SX.sym("x", mpcc.size)
    f = sum((out for b in mpcc.costs for out in _instances(b, mpcc, x)), ca.SX(0))
    g = ca.vertcat(*(out for b in mpcc.constraints for out in _instances(b, mpcc, x)))
    return _solve(case, mpcc, {"x": x, "f": f, "g": g}, began)


def plain_map(case: Case) -> Cost:
    """The assembled program, its derivatives left to CasADi."""
    began = time.process_time()
    mpcc = phases(case, straight_line(case)).mpcc
    program = assemble(mpcc, "never")
    return _solve(case, mpcc, {"x": program.x, "p": program.p, "f": program.f, "g": program.g}, began)


def _instances(block: Block, mpcc: Mpcc, x: ca.SX) -> list[ca.SX]:
    indices = gather(block, mpcc.offsets)
    return [block.function(x[i.tolist()], p, 0.0) for i, p in zip(indices, block.parameters, strict=True)]


def _solve(case: Case, mpcc: Mpcc, problem: dict[str, ca.SX | ca.MX], began: float) -> Cost:
    native = case.solver.native_options(Setup())
    solver = ca.nlpsol("reference", "ipopt", problem, {**OPTIONS, "ipopt": native})
    rows = [b for b in mpcc.constraints if b.instances]
    low, high = (np.concatenate([getattr(b, k).ravel() for b in rows]) for k in ("lower", "upper"))
    built = time.process_time()
    found = solver(
        x0=mpcc.guess, p=0.0 if "p" in problem else [], lbx=mpcc.lower, ubx=mpcc.upper, lbg=low, ubg=high
    )
    spent = time.process_time() - built
    return Cost(built - began, spent, int(solver.stats()["iter_count"]), float(found["f"]))


METHODS: dict[str, Callable[[Case], Cost]] = {
    "blocks, compiled": blocks("auto"),
    "blocks, interpreted": blocks("never"),
    "one SX graph": one_graph,
    "plain MX": plain_map,
}
STRATEGIES = {"phases": "", "enumeration": "strategy.finer=1", "relax": "strategy.margin=0"}
"""With what keeps each on the one grid."""
TIME_LIMIT = 120.0
LARGEST = {"plain MX": 100}
"""Where a method becomes too slow to wait for."""


def main(scenario: str) -> None:
    """Measure and print a Markdown table and the exponents of growth."""
    found: dict[str, dict[int, Cost]] = {name: {} for name in METHODS}
    print(
        "| N | method | build s | per iteration ms | iterations | whole s | ratio to blocks, compiled | cost |"
    )
    print("|---|---|---|---|---|---|---|---|")
    for n in SIZES:
        case = config.compose(f"+scenario={scenario}", f"scenario.intervals={n}")
        for name, method in METHODS.items():
            if n > LARGEST.get(name, n):
                continue
            if n == SIZES[0]:
                method(case)  # fills the cache and imports what is imported late
            cost = found[name][n] = method(case)
            ours = found["blocks, compiled"][n]
            ratio = (cost.build + cost.solve) / (ours.build + ours.solve)
            print(
                f"| {n} | {name} | {cost.build:.2f} | {cost.each * 1e3:.1f} | {cost.iterations} | "
                f"{cost.build + cost.solve:.2f} | {ratio:.1f} | {cost.objective:.6f} |",
                flush=True,
            )
    print(
        "\nExponents of growth with N (1 is linear): build; per iteration; per iteration over the last doubling\n"
    )
    for name, costs in found.items():
        build, each = ({n: getattr(c, k) for n, c in costs.items()} for k in ("build", "each"))
        last = dict(list(each.items())[-2:])
        print(f"- {name}: {_exponent(build):.2f}; {_exponent(each):.2f}; {_exponent(last):.2f}")
    strategies(scenario)


def strategies(scenario: str) -> None:
    """Print a table of whole strategies, compiled, by N, and its exponents."""
    print("\n| strategy | N | build and solve s | iterations | per iteration ms | travel time s | verdict |")
    print("|---|---|---|---|---|---|---|")
    found: dict[str, dict[int, tuple[float, float]]] = {name: {} for name in STRATEGIES}
    for name in STRATEGIES:
        for n in SIZES:
            asked = (f"+scenario={scenario}", f"scenario.intervals={n}", f"strategy={name}")
            case = config.compose(*asked, *STRATEGIES[name].split())
            ledger = Ledger(TIME_LIMIT)
            result = planned(case.strategy, case, ledger)
            spent = ledger.build_cpu + ledger.solve_cpu
            found[name][n] = spent, ledger.solve_cpu / max(ledger.iterations, 1)
            verdict = "certified" if judge(result, case, ledger).certified else "not certified"
            print(
                f"| {name} | {n} | {spent:.2f} | {ledger.iterations} | {found[name][n][1] * 1e3:.1f} | "
                f"{result.plan.travel_time:.4f} | {verdict}, {result.solved.outcome.claim} |",
                flush=True,
            )
    print("\nExponents of growth with N: build and solve; per iteration\n")
    for name, costs in found.items():
        whole, each = ({n: cost[i] for n, cost in costs.items()} for i in (0, 1))
        print(f"- {name}: {_exponent(whole):.2f}; {_exponent(each):.2f}")


def _exponent(values: dict[int, float]) -> float:
    return float(np.polyfit(np.log(list(values)), np.log(list(values.values())), 1)[0])


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scenario", nargs="?", default="circle", choices=("static", "linear", "circle"))
    main(parser.parse_args().scenario)
