"""A whole program as one shared library, so that any nlpsol plugin gets our derivatives.

Only IPOPT and BONMIN take derivative functions as options. Every plugin, however, asks its oracle for named
functions (nlp_f, nlp_jac_g, ...), and an oracle that is a library is asked for the symbol of that name. So
the assembled derivatives are written as C that calls the compiled blocks, and linked against them: 0.8 s
for N = 50 once, then cached. Blocks are compiled once for any N (see `benchbench.mpcc.derivatives`).
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path

import casadi as ca

from benchbench.mpcc.cache import cache_root, private
from benchbench.mpcc.compiler import FLAGS, start, succeeds
from benchbench.mpcc.derivatives import library
from benchbench.mpcc.problem import Mpcc
from benchbench.nlp.program import Program

Signatures = Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]]
"""Functions by name: (names of inputs, names of outputs)."""
PRODUCTS = {"nlp_grad_l", "fwd1_nlp_grad_l"}
"""Hessian products, which CasADi does not look for in a library but derives from the adjoint of nlp."""
ADJOINT: Signatures = {
    "adj1_nlp": (("x", "p", "out_f", "out_g", "lam_f", "lam_g"), ("grad_gamma_x", "grad_gamma_p")),
    "fwd1_adj1_nlp": (
        ("x", "p", "out_f", "out_g", "lam_f", "lam_g", "out_adj_x", "out_adj_p",
         "fwd_x", "fwd_p", "fwd_out_f", "fwd_out_g", "fwd_lam_f", "fwd_lam_g"),
        ("fwd_grad_gamma_x", "fwd_grad_gamma_p"),
    ),
}  # fmt: skip


def oracle(program: Program, mpcc: Mpcc, wanted: Signatures, seconds: float) -> ca.Function | None:
    """Return the program as a library function with all `wanted` functions beside it, or None if impossible.

    Impossible: blocks that should be compiled and are not, two blocks with one name, a function we do not know, or a
    compiler that fails or takes longer than so many CPU seconds.
    """
    libraries = _libraries(mpcc) if program.compiled else None
    terms = _terms(program)
    known = {k: v for k, v in wanted.items() if k not in PRODUCTS}
    if libraries is None or not all(name in terms for i, o in known.values() for name in (*i, *o)):
        return None
    functions = {"nlp": (("x", "p"), ("f", "g")), **known}
    if PRODUCTS & wanted.keys():
        functions |= ADJOINT
    with tempfile.TemporaryDirectory(dir=cache_root()) as scratch:
        source = Path(scratch) / "nlp.c"
        generator = ca.CodeGenerator(source.name)
        for name, (inputs, outputs) in functions.items():
            generator.add(ca.Function(
                name, [terms[i] for i in inputs], [terms[o] for o in outputs], list(inputs), list(outputs)
            ))  # fmt: skip
        generator.generate(scratch + os.sep)
        compiled = _compile(source, libraries, seconds)
    return ca.external("nlp", str(compiled)) if compiled else None


def signatures(solver: ca.Function) -> Signatures:
    """Return the functions that an nlpsol asked its oracle for."""
    found = (solver.get_function(name) for name in solver.get_function())
    return {f.name(): (tuple(f.name_in()), tuple(f.name_out())) for f in found}


def _libraries(mpcc: Mpcc) -> list[Path] | None:
    """Libraries of the compiled blocks (small ones go into ours); None when two define the same symbols."""
    by_name: dict[str, Path] = {}
    for block in (*mpcc.costs, *mpcc.constraints):
        path = library(block.function) if block.instances else None
        if path is not None and by_name.setdefault(block.function.name(), path) != path:
            return None
    return sorted(set(by_name.values()))


def _terms(program: Program) -> dict[str, ca.MX]:
    """Everything a plugin may name, as an expression of x, p and multipliers."""
    x, p, n, m = program.x, program.p, program.x.shape[0], program.g.shape[0]
    lam_f, lam_g = ca.MX.sym("lam_f"), ca.MX.sym("lam_g", m)
    forward = ca.MX.sym("fwd_x", n)
    gradient, jacobian = program.gradient(x, p)[1], program.jacobian(x, p)[1]
    upper = program.hessian(x, p, lam_f, lam_g)
    hessian, unused = ca.triu2symm(upper), ca.MX.nan(1)  # what depends on sigma is never used
    return {
        "x": x, "p": p, "lam_f": lam_f, "lam_g": lam_g, "f": program.f, "g": program.g,
        "grad_f_x": gradient, "jac_g_x": jacobian,
        "hess_gamma_x_x": hessian, "triu_hess_gamma_x_x": upper, "tril_hess_gamma_x_x": upper.T,
        "grad_gamma_x": ca.densify(gradient * lam_f + ca.mtimes(jacobian.T, lam_g)), "grad_gamma_p": unused,
        "fwd_x": forward, "fwd_grad_gamma_p": unused,
        "fwd_grad_gamma_x": ca.densify(ca.mtimes(hessian, forward)),  # multipliers are held in every product
        "fwd_p": ca.MX.sym("fwd_p"), "fwd_lam_f": ca.MX.sym("fwd_lam_f"), "fwd_lam_g": ca.MX.sym("fwd_lam_g", m),
        **{name: ca.MX.sym(name, ca.Sparsity(size, 1)) for name, size in  # empty: not depended on
           (("out_f", 1), ("out_g", m), ("out_adj_x", n), ("out_adj_p", 1), ("fwd_out_f", 1), ("fwd_out_g", m))},
    }  # fmt: skip


def _compile(source: Path, libraries: list[Path], seconds: float) -> Path | None:
    """Compile and link, or find the result of an earlier run; None when the compiler fails."""
    links = [str(path) for path in libraries]
    key = hashlib.sha256("|".join([source.read_text(), *links, *FLAGS]).encode()).hexdigest()[:32]
    target = cache_root() / f"{key}.so"
    if target.is_file() and private(target):
        return target
    made = source.with_suffix(".so")
    if not succeeds(start(source, made, seconds, libraries), "the assembled program stays interpreted"):
        return None
    made.chmod(0o700)
    os.replace(made, target)
    return target
