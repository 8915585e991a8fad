"""The stage structure of an MPCC: the same problem in the order an optimal-control solver wants.

Stage solvers eliminate one stage after the other. They want unknowns ordered x_0, u_0, x_1, u_1, ..., x_N,
rows ordered stage by stage, and x_{k+1} = F(x_k, u_k) as the only link between two stages. Our
transcriptions are implicit and share durations, so both are brought into that form by copies:

    state   x_k = [node unknowns that a row of the stage before reads, global unknowns (durations)]
    input   u_k = [other node unknowns, interval unknowns, y_k]
    links   x_{k+1} = y_k for node unknowns, x_{k+1} = x_k for global ones; all linear
    rows    what reads nodes k and k + 1 reads x_k, u_k and the copy y_k in place of x_{k+1}

The copies change nothing in the solution: bounds stay where they were, no row is added but the links.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from benchbench.ground.arrays import Array, Index
from benchbench.ground.errors import IncompatibleCase
from benchbench.mpcc.problem import Block, Mpcc, Slot, Variable, block, gather
from benchbench.nlp.program import Program
from benchbench.nlp.solver import Point

ALL = "stages"
"""Name of the one variable of a staged problem."""


@dataclass(frozen=True)
class Staged:
    """A problem in stage form.

    mpcc    the staged problem; its only variable holds all unknowns in stage order, (n, 1)
    order   (m,) row i of the stage-ordered constraints is row `order[i]` of the staged problem's own order
    states, inputs, path   nx, nu and the number of path rows of each stage, N + 1 numbers each
    source  (n,) the original unknown that each staged unknown is or copies
    home    (n_original,) where each original unknown itself stands
    """

    mpcc: Mpcc
    order: Index
    states: tuple[int, ...]
    inputs: tuple[int, ...]
    path: tuple[int, ...]
    source: Index
    home: Index

    def reorder(self, program: Program) -> Program:
        """Put the rows of an assembled program of `mpcc` into stage order."""
        order, x, p = self.order.tolist(), program.x, program.p
        lam_f, lam = ca.MX.sym("lam_f"), ca.MX.sym("lam_g", len(order))
        g, jacobian = program.jacobian(x, p)
        hessian = program.hessian(x, p, lam_f, lam[np.argsort(self.order).tolist()])
        return replace(
            program, g=program.g[order], lower_g=program.lower_g[order], upper_g=program.upper_g[order],
            jacobian=ca.Function("nlp_jac_g", [x, p], [g[order], jacobian[order, :]], ["x", "p"], ["g", "jac_g_x"]),
            hessian=ca.Function("nlp_hess_l", [x, p, lam_f, lam], [hessian], ["x", "p", "lam_f", "lam_g"],
                                ["triu_hess_gamma_x_x"]),
        )  # fmt: skip

    def there(self, point: Point) -> Point:
        """Bring a start of the original problem here; multipliers are not carried."""
        return Point(point.x[self.source])

    def back(self, point: Point) -> Point:
        """Bring a solution back to the original problem; its multipliers are those of its own rows and bounds."""
        links = len(self.order) - sum(self.path)
        lam_g = None if point.lam_g is None else point.lam_g[np.argsort(self.order)][links:]
        return Point(point.x[self.home], lam_g, None if point.lam_x is None else point.lam_x[self.home])


def stages(mpcc: Mpcc) -> Staged:
    """Bring a problem without pairs into stage form.

    Raises IncompatibleCase when no variable has one row per node, or when an instance of a block reads
    more than two neighbouring nodes and the interval between them.
    """
    if mpcc.pairs:
        raise ValueError("pairs must be relaxed before they are put into stages")
    layout = _Layout.of(mpcc)
    costs, constraints = ([layout.moved(b, mpcc) for b in part] for part in (mpcc.costs, mpcc.constraints))
    links = layout.links()
    lower, upper = layout.bound(mpcc.lower, -np.inf), layout.bound(mpcc.upper, np.inf)
    guess = mpcc.guess[layout.source]
    variable = Variable(ALL, lower[:, None], upper[:, None], guess[:, None])
    stage = np.concatenate(
        [np.repeat(layout.stage(b, mpcc), b.function.size1_out(0)) for b in mpcc.constraints]
    )
    link_stage = np.repeat(np.arange(layout.intervals), links.instances // layout.intervals)
    return Staged(
        mpcc=Mpcc((variable,), (links, *constraints), tuple(costs)),
        order=np.argsort(np.concatenate([link_stage, stage]), kind="stable"),
        states=layout.states, inputs=layout.inputs,
        path=tuple(np.bincount(stage, minlength=layout.intervals + 1).tolist()),
        source=layout.source, home=layout.home,
    )  # fmt: skip


@dataclass(frozen=True)
class _Layout:
    """Where everything goes. `node`, `interval` (n_original,) number of the unknown's node or interval, else -1.

    home, ahead (n_original,)  place of the unknown itself, and of its copy in the stage before, else -1
    carried (N + 1, globals)   places of the copies of the global unknowns; column[i] of unknown i or -1
    """

    intervals: int
    node: Index
    interval: Index
    column: Index
    home: Index
    ahead: Index
    carried: Index
    source: Index
    states: tuple[int, ...]
    inputs: tuple[int, ...]

    @classmethod
    def of(cls, mpcc: Mpcc) -> _Layout:
        count = _intervals(mpcc)
        node, interval = _owners(mpcc, count)
        shared = np.flatnonzero((node < 0) & (interval < 0))
        column = np.full(mpcc.size, -1)
        column[shared] = np.arange(len(shared))
        linked = _linked(mpcc, node, interval)
        home, ahead = np.full(mpcc.size, -1), np.full(mpcc.size, -1)
        carried: list[Index] = []
        order: list[Index] = []
        states: list[int] = []
        inputs: list[int] = []
        for k in range(count + 1):
            state = np.flatnonzero((node == k) & linked)
            free = np.flatnonzero(((node == k) & ~linked) | (interval == k))
            copies = np.flatnonzero((node == k + 1) & linked)
            first = sum(len(known) for known in order)
            part = np.concatenate([state, shared, free, copies])
            place = first + np.arange(len(part))
            own = len(state) + len(shared)
            home[state], home[free] = place[: len(state)], place[own : own + len(free)]
            ahead[copies] = place[own + len(free) :]
            carried.append(place[len(state) : own])
            order.append(part)
            states.append(own)
            inputs.append(len(part) - own)
        home[shared] = carried[0]
        return cls(
            intervals=count, node=node, interval=interval, column=column, home=home, ahead=ahead,
            carried=np.array(carried), source=np.concatenate(order), states=tuple(states), inputs=tuple(inputs),
        )  # fmt: skip

    def stage(self, block: Block, mpcc: Mpcc) -> Index:
        """Stage of each instance (instances,): the first node or interval it reads, 0 if none."""
        return _stage(block, gather(block, mpcc.offsets), self.node, self.interval)

    def moved(self, block: Block, mpcc: Mpcc) -> Block:
        """The block reading the staged unknowns."""
        index = gather(block, mpcc.offsets)
        stage = self.stage(block, mpcc)[:, None]
        place = np.where(self.node[index] == stage + 1, self.ahead[index], self.home[index])
        column = self.column[index]
        place = np.where(
            column >= 0, self.carried[stage, np.maximum(column, 0)] if self.carried.size else place, place
        )
        return replace(block, slots=(Slot(ALL, place),))

    def links(self) -> Block:
        """x_{k+1} = y_k and x_{k+1} = x_k, one scalar per instance, stage by stage."""
        pairs = []
        for k in range(self.intervals):
            linked = np.flatnonzero((self.node == k + 1) & (self.ahead >= 0))
            pairs.append(np.stack([self.home[linked], self.ahead[linked]], axis=1))
            pairs.append(np.stack([self.carried[k + 1], self.carried[k]], axis=1))
        place = np.concatenate(pairs)
        return block("link", [Slot(ALL, place)], lambda z: z[0] - z[1])

    def bound(self, values: Array, free: float) -> Array:
        """Bounds of the staged unknowns: copies are free."""
        spread = np.full(len(self.source), free)
        spread[self.home] = values
        return spread


def _intervals(mpcc: Mpcc) -> int:
    """N: a variable of which some block reads two neighbouring rows has one row per node."""
    shapes = {v.name: v.guess.shape for v in mpcc.variables}
    for read in mpcc.constraints:
        for i, one in enumerate(read.slots):
            for two in read.slots[i + 1 :]:
                if one.variable != two.variable or one.index.shape != two.index.shape or not one.index.size:
                    continue
                rows, columns = shapes[one.variable]
                if rows > 2 and np.all(two.index - one.index == columns):
                    return int(rows - 1)
    raise IncompatibleCase(
        "solver", "this problem has no stages: no constraint reads two neighbouring nodes", "ipopt, uno"
    )


def _owners(mpcc: Mpcc, count: int) -> tuple[Index, Index]:
    """Node and interval of every unknown: N + 1 rows are nodes, a multiple of N intervals, the rest global."""
    node, interval = np.full(mpcc.size, -1), np.full(mpcc.size, -1)
    for v in mpcc.variables:
        rows, columns = v.guess.shape
        where = slice(mpcc.offsets[v.name], mpcc.offsets[v.name] + v.size)
        row = np.repeat(np.arange(rows), columns)
        if rows == count + 1:
            node[where] = row
        elif rows >= count and rows % count == 0:
            interval[where] = row // (rows // count)
    return node, interval


def _linked(mpcc: Mpcc, node: Index, interval: Index) -> np.ndarray:
    """Which node unknowns are states: some instance reads their column as the next node's."""
    column = np.concatenate(
        [mpcc.offsets[v.name] + np.tile(np.arange(v.guess.shape[1]), len(v.guess)) for v in mpcc.variables]
    )
    seen = np.zeros(mpcc.size, bool)
    for one in (*mpcc.constraints, *mpcc.costs):
        index = gather(one, mpcc.offsets)
        later = node[index] == _stage(one, index, node, interval)[:, None] + 1
        seen[column[index[later]]] = True
    return seen[column] & (node >= 0)


def _stage(block: Block, index: Index, node: Index, interval: Index) -> Index:
    far = np.iinfo(np.int64).max
    both = np.stack([node[index], interval[index]])
    stage = np.where(both < 0, far, both).min(axis=(0, 2), initial=far)
    stage = np.where(stage == far, 0, stage)
    ok = (node[index] <= stage[:, None] + 1) & (interval[index] <= stage[:, None])
    if not np.all(ok):
        raise IncompatibleCase(
            "solver",
            f"'{block.name}' reads more than one interval, so the problem has no stages",
            "ipopt, uno",
        )
    return stage
