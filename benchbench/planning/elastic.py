"""What stands in the way of a flight: the same problem with slack in every inequality, and least slack as its cost.

Equations (dynamics, durations) and bounds of unknowns stay as they are. A solution without slack is a start for the problem itself;
one with slack is a point from which no step lowers what is violated, so its slacks and multipliers say what conflicts there. That is
no proof: another point may have none.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from benchbench.formulation.problem import Problem
from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Block, Mpcc, Slot, Variable, evaluate
from benchbench.nlp.ledger import Ledger
from benchbench.planning.case import Case
from benchbench.planning.result import Result
from benchbench.planning.strategy import pose

TIE = 1e-3
"""Weight of the problem's own cost beside the slacks: it only decides between points with the same slack."""
NONE = 1e-4
"""Sum of slacks, scaled as the rows are, below which the problem is as good as feasible."""
PREFIX = "slack_"


@dataclass(frozen=True)
class Eased:
    """The least slack that was found; `slack`: largest of each block, in its rows' scale, by its name."""

    result: Result
    slack: dict[str, float]

    @property
    def feasible(self) -> bool:
        """Whether it is a flight that keeps everything on this grid, whether the solver was content with it or not."""
        return self.total <= NONE

    @property
    def total(self) -> float:
        """Sum of the largest slacks."""
        return sum(self.slack.values())

    @property
    def conflicts(self) -> bool:
        """Whether a solver found a point of least slack at which some is left."""
        return self.result.claimed and not self.feasible


def ease(problem: Problem, case: Case, ledger: Ledger, stage: str) -> Eased:
    """Solve a problem of a smooth kind with slack."""
    with ledger.building():
        soft = with_slack(problem.mpcc)
    found = pose(replace(problem, mpcc=soft), case, ledger, stage)
    values = {v.name: found.solved.values[v.name] for v in soft.variables if v.name.startswith(PREFIX)}
    slack = {name.removeprefix(PREFIX): float(np.max(value, initial=0.0)) for name, value in values.items()}
    return Eased(found, slack)


def with_slack(mpcc: Mpcc) -> Mpcc:
    """Return the problem with slack >= 0 in all rows that are no equations; raises ValueError for one with pairs."""
    if mpcc.pairs:
        raise ValueError("pairs must be decided before slack is asked for")
    soft = [_soft(one, mpcc) if np.any(one.lower < one.upper) else (one, None) for one in mpcc.constraints]
    slacks = tuple(slack for _, slack in soft if slack is not None)
    costs = [_weighed(one) for one in mpcc.costs] + [_total(slack) for slack in slacks]
    return Mpcc(mpcc.variables + slacks, tuple(one for one, _ in soft), tuple(costs))


def _soft(one: Block, mpcc: Mpcc) -> tuple[Block, Variable]:
    """Lower <= g + up - down <= upper; a row has a slack for each of its sides."""
    z, p, sigma = one.function.sx_in()
    rows = one.function.size1_out(0)
    up, down = ca.SX.sym("up", rows), ca.SX.sym("down", rows)
    g = one.function(z, p, sigma) + up - down
    function = ca.Function(f"soft_{one.function.name()}", [ca.vertcat(z, up, down), p, sigma], [g])
    now = evaluate(one, mpcc, mpcc.guess)
    missing = np.hstack([np.maximum(one.lower - now, 0.0), np.maximum(now - one.upper, 0.0)])
    sided = np.hstack([np.isfinite(one.lower), np.isfinite(one.upper)])
    most, guess = np.where(sided, np.inf, 0.0), np.where(sided & np.isfinite(missing), missing, 0.0)
    slack = Variable(f"{PREFIX}{one.name}", np.zeros_like(guess), most, guess)
    reads = Slot(slack.name, np.arange(guess.size).reshape(guess.shape))
    return replace(one, function=function, slots=(*one.slots, reads)), slack


def _total(slack: Variable) -> Block:
    z, none = ca.SX.sym("z", slack.guess.shape[1]), ca.SX.sym("p", 0)
    function = ca.Function("total_slack", [z, none, ca.SX.sym("sigma")], [ca.sum1(z)])
    count = len(slack.guess)
    reads = Slot(slack.name, np.arange(slack.size).reshape(slack.guess.shape))
    zero: Array = np.zeros((count, 1))
    return Block(f"total_{slack.name}", function, (reads,), np.zeros((count, 0)), zero, zero)


def _weighed(one: Block) -> Block:
    z, p, sigma = one.function.sx_in()
    function = ca.Function(f"tie_{one.function.name()}", [z, p, sigma], [TIE * one.function(z, p, sigma)])
    return replace(one, function=function)
