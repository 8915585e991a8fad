"""MPCCs that come ready-made: files as in NOSBENCH, the problems of pympcc, folders as sweeps."""

from __future__ import annotations

import gzip
import json
import os
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest

from benchbench.certificate.certify import certify_problem
from benchbench.certificate.limits import ProblemLimits
from benchbench.cli import commands
from benchbench.ground.errors import BadInput, IncompatibleCase
from benchbench.mpcc.problem import Mpcc, evaluate
from benchbench.mpcc.residuals import residuals
from benchbench.nlp.homotopy import Path as Schedule
from benchbench.nlp.homotopy import homotopy
from benchbench.nlp.ledger import Ledger
from benchbench.nlp.program import assemble
from benchbench.nlp.solver import Claim, Outcome, Point, Prepared, Setup, Solver
from benchbench.run.config import compose, compose_any
from benchbench.run.pipeline import Run, run, write
from benchbench.run.summary import show
from benchbench.storage.table import read
from benchbench_plugins.collections.nosbench import MpccFile
from benchbench_plugins.collections.pympcc_set import PympccSet

sys.path.append(str(Path(__file__).resolve().parents[1] / "benchmarks"))

from nosbench import rows
from nosbench import solved as judged

NOSBENCH = Path(os.environ.get("NOSBENCH", Path(__file__).parents[2] / "shared" / "nosbench"))
QUICK = ("2BCLS_001_001_002_3_GL_CLS_7_ELC_0", "986OM_001_001_002_2_RIIA_STEP_7_FIL_0",
         "SMOCP_001_006_003_3_RIIA_STEP_7_FIL_0", "SMCRS_001_001_032_2_GL_STEWART_3_FIL_0")  # fmt: skip


@pytest.fixture
def told() -> dict[str, Any]:
    """Minimise (a - p)^2 + (b - 1)^2 + c with c >= 0.5, a + b + c <= 9, 0 <= a, b complementary; p = 3: (3, 0, 0.5)."""
    w, p = ca.SX.sym("w", 3), ca.SX.sym("p")
    out = {
        "augmented_objective_fun": (w[0] - p) ** 2 + (w[1] - 1) ** 2 + w[2],
        "g_fun": ca.sum1(w), "G_fun": w[0], "H_fun": w[1],
    }  # fmt: skip
    functions = {key: ca.Function(key, [w, p], [value]).serialize() for key, value in out.items()}
    numbers = {
        "w0": [0.4, 0.2, -7],
        "lbw": [-9, -9, 0.5],
        "ubw": [9, 9, 9],
        "lbg": -np.inf,
        "ubg": 9,
        "p0": 3,
    }
    return {**functions, **numbers}


def stored(told: dict[str, Any], path: Path) -> Path:
    text = json.dumps(told).encode()
    path.write_bytes(gzip.compress(text) if path.suffix == ".gz" else text)
    return path


def solved(path: Path, *overrides: str) -> Run:
    return run(compose_any("+scenario=mpcc_file", f"scenario.path='{path}'", *overrides))


def test_a_file_becomes_what_it_says(told: dict[str, Any], tmp_path: Path) -> None:
    mpcc = MpccFile(stored(told, tmp_path / "small.json")).mpcc()
    x = np.array([1.0, 2.0, 4.0])
    named = {block.name: block for block in (*mpcc.constraints, *mpcc.costs, mpcc.pairs[0].block)}
    assert evaluate(named["g"], mpcc, x).item() == 7.0
    assert evaluate(named["f"], mpcc, x).item() == 4.0 + 1.0 + 4.0
    np.testing.assert_array_equal(evaluate(named["GH"], mpcc, x), [[1.0, 2.0]])
    np.testing.assert_array_equal(mpcc.guess, [0.4, 0.2, 0.5])  # clipped into its bounds
    assert (named["g"].lower.item(), named["g"].upper.item()) == (-np.inf, 9.0)


@pytest.mark.parametrize("name", ["small.json", "small.json.gz", "a,b 'c'=1.json"])
def test_the_known_solution_is_found_and_recorded(name: str, told: dict[str, Any], tmp_path: Path) -> None:
    path = stored(told, tmp_path / name)
    case = compose_any(
        "+scenario=mpcc_file", "scenario.path=" + commands.run("collection", [str(tmp_path)])[2][14:]
    )  # type: ignore[index]
    done = run(case)
    record = done.record
    assert record["certified"] and record["status"] == "certified" and done.certificate.flight is None
    assert record["scenario"] == path.name.removesuffix(".gz").removesuffix(".json")
    assert record["objective"] == pytest.approx(1.5, abs=1e-6)
    assert (record["stationarity"], record["b_stationary"]) == ("S", "yes")
    assert (record["n_variables"], record["n_constraints"], record["n_pairs"]) == (3, 1, 1)
    for absent in (
        "vehicle",
        "dynamics",
        "guess",
        "intervals",
        "kappa_init",
        "travel_time_s",
        "lower_bound_s",
    ):
        assert record[absent] is None


def test_its_files_and_its_summary(
    told: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    done = solved(stored(told, tmp_path / "small.json"))
    done.record["run_id"] = "one"
    paths = write(done, tmp_path / "run", tmp_path / "results", "x: 1")
    found = json.loads(paths["solution"].read_text())
    np.testing.assert_allclose(np.ravel(found["w"]), [3, 0, 0.5], atol=1e-4)
    assert read(tmp_path / "results").scenario.tolist() == ["small"]
    show(done.record, paths)
    said = capsys.readouterr().out
    assert "objective    1.5" in said and "3 unknowns, 1 constraints, 1 pairs" in said
    assert "travel time" not in said and "None" not in said


def test_a_strict_certificate_rejects_what_the_relaxation_leaves(
    told: dict[str, Any], tmp_path: Path
) -> None:
    """Judged are sigma and feasibility as they are: 1e-3 is not complementary."""
    done = solved(stored(told, tmp_path / "small.json"), "strategy.last=1e-3")
    assert not done.certificate.certified
    assert "product of a complementarity pair" in done.certificate.reasons[0]


def test_a_path_that_breaks_off_gives_its_last_good_point_and_claims_nothing(
    told: dict[str, Any], tmp_path: Path
) -> None:
    """Its rows ask for a = b = 0.5, so that G H <= sigma is feasible down to sigma = 0.25 only."""
    w, p = ca.SX.sym("w", 3), ca.SX.sym("p")
    rows = ca.vertcat(w[0] - 0.5, w[1] - 0.5)
    told |= {"g_fun": ca.Function("g", [w, p], [rows]).serialize(), "lbg": [0, 0], "ubg": [0, 0]}
    done = solved(stored(told, tmp_path / "stuck.json"))
    assert not done.record["claimed_success"] and done.record["status"] == "infeasible"
    assert done.record["max_violation"] < 1e-6
    assert done.record["max_product"] == pytest.approx(0.25, abs=1e-6)


def test_a_penalty_is_not_part_of_the_objective(told: dict[str, Any], tmp_path: Path) -> None:
    done = solved(stored(told, tmp_path / "small.json"), "relaxation=l1_penalty", "strategy=relax")
    x = done.result.solved.x
    assert done.record["objective"] == pytest.approx((x[0] - 3) ** 2 + (x[1] - 1) ** 2 + x[2], rel=1e-12)


W, P = ca.SX.sym("w", 3), ca.SX.sym("p")


def given(*values: ca.SX) -> str:
    return ca.Function("given", [W, P], values).serialize()


NULL = None
"""What JSON writes for a number that is none; a value that is None alone takes its key away."""
SPOILED = [
    ("g_fun", None, "has no 'g_fun'"),
    ("w0", [0.4, NULL, -7], r"w0\[1\] is nan, must be finite"),
    ("w0", [0.4, 0.2, -np.inf], r"w0\[2\] is -inf, must be finite"),
    ("w0", [0.4, [0.2, -7]], "w0 must be a list of numbers"),
    ("w0", [0.4, 0.2], "lbw has 3 numbers, must have as many as w0 has, 2"),
    ("p0", float("nan"), r"p0\[0\] is nan, must be finite"),
    ("p0", ["three"], "p0 must be a list of numbers"),
    ("p0", [10**400], "p0 must be a list of numbers"),
    ("p0", [3, 3], r"f takes \[3, 1\] numbers, must take \[3, 2\], as many as w0 and p0 have"),
    ("lbw", -9, "lbw has 1 numbers, must have as many as w0 has, 3"),
    ("lbw", [-9, NULL, 0.5], r"lbw\[1\] is nan, must be a number or infinite"),
    ("ubw", [9, 9, 0.0], r"lbw\[2\] is 0.5 and ubw\[2\] 0, must be lbw <= ubw"),
    ("lbw", [-9, -9, np.inf], r"lbw\[2\] is inf and ubw\[2\] 9, must"),
    ("lbg", [0.0, 0.0], "lbg has 2 numbers, must have as many as g gives, 1"),
    ("lbg", [], "lbg has 0 numbers, must have as many as g gives, 1"),
    ("ubg", [NULL], r"ubg\[0\] is nan, must be a number or infinite"),
    ("lbg", 10, r"lbg\[0\] is 10 and ubg\[0\] 9, must be lbg <= ubg"),
    ("ubg", -np.inf, r"ubg\[0\] -inf, must be lbg <= ubg with a finite number between"),
    ("augmented_objective_fun", given(W[:2]), r"f gives \[2\] numbers, must give \[1\]"),
    ("g_fun", given(W[0], W[1]), r"g gives \[1, 1\] numbers, must give one list"),
    ("G_fun", given(W[:0]), r"H gives \[1\] numbers, must give as many as G, \[0\]"),
    ("H_fun", given(W), r"H gives \[3\] numbers, must give as many as G, \[1\]"),
    ("H_fun", ca.Function("H", [W], [W[1]]).serialize(), r"H takes \[3\] numbers, must take \[3, 1\]"),
    ("G_fun", "nonsense", "is no MPCC"),
]


@pytest.mark.parametrize(("key", "value", "text"), SPOILED)
def test_a_file_that_is_no_problem(
    key: str, value: Any, text: str, told: dict[str, Any], tmp_path: Path
) -> None:
    told[key] = value
    if value is None:
        del told[key]
    with pytest.raises(BadInput, match=text) as caught:
        MpccFile(stored(told, tmp_path / "bad.json")).mpcc()
    assert caught.value.field == "scenario.path"


def test_bounds_may_be_infinite_and_functions_give_rows(told: dict[str, Any], tmp_path: Path) -> None:
    told |= {"lbw": [-np.inf] * 3, "ubw": [np.inf] * 3}
    told |= {"g_fun": given(W.T), "lbg": [0, 0, 0.5], "ubg": [np.inf] * 3}
    done = solved(stored(told, tmp_path / "small.json"))
    assert done.certificate.certified
    np.testing.assert_allclose(done.result.solved.x, [3, 0, 0.5], atol=1e-4)


@pytest.mark.parametrize(
    "data", [gzip.compress(b"{}")[:10] + b"\xff" * 40, b"[" * 10**5], ids=["gzip", "nested"]
)
def test_a_file_that_is_damaged(data: bytes, tmp_path: Path) -> None:
    path = tmp_path / "bad.json"
    path.write_bytes(data)
    with pytest.raises(BadInput, match="is no JSON") as caught:
        MpccFile(path).mpcc()
    assert caught.value.field == "scenario.path"


@pytest.mark.parametrize(
    ("a", "b", "violation"), [(3.0, 0.0, 0.0), (3.0, -1e-3, 1e-3), (-2e-3, 1.0, 2e-3), (-1e-3, -4e-3, 4e-3)]
)
def test_without_other_limits_the_signs_of_pairs_are_asked_for(
    a: float, b: float, violation: float, told: dict[str, Any], tmp_path: Path
) -> None:
    """At points of our own: all bounds and rows of the file hold there, only G = a or H = b is below zero."""
    told |= {"lbw": [-9, -9, 0.5]}
    mpcc = MpccFile(stored(told, tmp_path / "small.json")).mpcc()
    limits = ProblemLimits(residual=1e-6, complementarity=None, product=None)
    certificate = certify_problem(residuals(mpcc, np.array([a, b, 0.5])), limits)
    (signs,) = (check for check in certificate.checks if check.name == "complementarity_sign")
    assert (signs.value, signs.limit) == (violation, 1e-6)
    assert signs.ok == certificate.certified == (violation == 0.0)


@pytest.mark.parametrize(
    ("overrides", "field"),
    [
        (("scenario.path=nowhere.json",), "scenario.path"),
        (("scenario.path=x.json", "vehicle=table1"), "vehicle"),
        (("scenario.path=x.json", "+scenario.pathh=1"), "scenario"),
    ],
)
def test_bad_input_names_the_field(overrides: tuple[str, ...], field: str) -> None:
    with pytest.raises(BadInput) as caught:
        run(compose_any("+scenario=mpcc_file", *overrides))
    assert caught.value.field.startswith(field)


def test_choices_that_do_not_go_together() -> None:
    with pytest.raises(IncompatibleCase, match="plans flights"):
        run(compose_any("+scenario=pympcc", "scenario.problem=kth1", "strategy=phases"))
    with pytest.raises(BadInput, match="no flight"):
        compose("+scenario=pympcc", "scenario.problem=kth1")
    with pytest.raises(BadInput, match="certificate"):
        compose("+scenario=static", "certificate=mpcc")


def test_all_of_pympcc_reach_their_known_optima() -> None:
    from pympcc.benchmarks import ALL_PROBLEMS

    case = compose_any("+scenario=pympcc", "scenario.problem=kth1")
    for spec in ALL_PROBLEMS:
        record = run(replace(case, scenario=PympccSet(spec.name))).record  # type: ignore[type-var]
        assert record["certified"], spec.name
        assert record["objective"] == pytest.approx(spec.f_opt, abs=max(spec.f_atol, 1e-4)), spec.name
        assert record["b_stationary"] == "yes", spec.name


def test_a_folder_is_a_sweep_of_its_files(told: dict[str, Any], tmp_path: Path) -> None:
    for name in ("b.json.gz", "a.json", "notes.txt"):
        stored(told, tmp_path / name)
    arguments = commands.run("collection", [str(tmp_path), "relaxation=scholtes,direct"])
    assert arguments == [
        "-m", "+scenario=mpcc_file", f"scenario.path='{tmp_path / 'a.json'}','{tmp_path / 'b.json.gz'}'",
        "relaxation=scholtes,direct",
    ]  # fmt: skip
    with pytest.raises(BadInput, match="no problem file"):
        commands.run("collection", [str(tmp_path / "nowhere")])


# --- problems nobody here wrote; the data has no licence and is not part of the repository -----------------------


@pytest.fixture
def nosbench() -> Path:
    if not NOSBENCH.is_dir():
        pytest.skip(
            f"no NOSBENCH problems in {NOSBENCH} (set NOSBENCH); they have no licence and are not shipped"
        )
    return NOSBENCH


@pytest.mark.parametrize("name", QUICK)
def test_nosbench_is_solved_as_its_judge_says(name: str, nosbench: Path) -> None:
    best = {
        entry["name"]: entry["best_known_objective"]
        for entry in json.loads((nosbench / "manifest.json").read_text())
    }
    path = nosbench / f"{name}.json.gz"
    done = solved(path, "time_limit=60")
    assert done.certificate.certified
    assert judged(path, done.result.solved.x, best[name])


def test_the_judge_of_nosbench_reads_the_file_alone(told: dict[str, Any], tmp_path: Path) -> None:
    for path in (stored(told, tmp_path / "small.json"), stored(told, tmp_path / "small.json.gz")):
        best = 1.5  # (3 - 3)^2 + (0 - 1)^2 + 0.5
        assert judged(path, np.array([3.0, 0.0, 0.5]), best)
        assert judged(path, np.array([3.0, 0.0, 0.5]), None)
        assert not judged(path, np.array([3.0, 1e-3, 0.5]), best), "both sides above zero"
        assert not judged(path, np.array([3.0, 0.0, 0.4]), best), "below its bound"
        assert not judged(path, np.array([3.0, 0.0, 5.0]), best), "more than twice the best known cost"
        assert not judged(path, np.array([3.0, 0.0, np.nan]), None)


def test_the_table_of_a_folder_leaves_out_runs_of_others(
    told: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of four runs in one results folder two are of problems of this folder, one of them without a solution."""
    monkeypatch.setattr("nosbench.OUTPUT", tmp_path / "results")
    folder, empty = tmp_path / "problems", tmp_path / "empty"
    folder.mkdir()
    empty.mkdir()
    for name, known in {"here": True, "failed": True, "elsewhere": False, "static": False}.items():
        place = tmp_path / "results" / name
        place.mkdir(parents=True)
        record = {"scenario": name, "relaxation": "scholtes", "strategy": "relax", "started_at": "1"}
        (place / "record.json").write_text(json.dumps(record))
        if known:
            stored(told, folder / f"{name}.json.gz")
        if name in ("here", "elsewhere"):
            (place / "solution.json").write_text(json.dumps({"w": [3.0, 0.0, 0.5]}))
    assert dict(zip(*rows(folder)[["scenario", "verified"]].to_numpy().T, strict=True)) == {
        "here": True,
        "failed": False,
    }
    with pytest.raises(SystemExit, match="no run of a problem of"):
        rows(empty)


@pytest.mark.parametrize("retries", [0, 2])
def test_continuation_returns_its_last_good_point(told: dict[str, Any], tmp_path: Path, retries: int) -> None:
    """The product of the pair must be 0.02 or more, so that sigma = 1 and 0.1 can be solved and 0.01 cannot."""
    w, p = ca.SX.sym("w", 3), ca.SX.sym("p")
    told |= {"g_fun": ca.Function("g_fun", [w, p], [w[0] * w[1]]).serialize(), "lbg": 0.02, "ubg": 9}
    done = solved(stored(told, tmp_path / "small.json"), "relaxation=scholtes", f"strategy.retries={retries}")
    a, b, _ = done.result.solved.x
    assert 0.02 - 1e-7 <= a * b <= 0.1 + 1e-7
    assert not done.record["claimed_success"] and not done.record["certified"]


class Stuck(Solver):
    """Solves nothing: reports solve after solve what it is told, and remembers where each began."""

    def __init__(self, claims: Sequence[Claim]) -> None:
        self.claims, self.starts = list(claims), list[float]()

    def native_options(self, setup: Setup) -> dict[str, Any]:
        return {}

    def version(self) -> str:
        return "1"

    def prepare(self, mpcc: Mpcc, setup: Setup) -> Prepared:
        def solve(sigma: float, start: Point) -> Outcome:
            self.starts.append(float(start.x[0]))
            claim, x = self.claims[len(self.starts) - 1], np.full(mpcc.size, float(len(self.starts)))
            return Outcome(claim, Point(x), 0.0, 1, 1, 0.0, "")

        return solve


def test_what_failed_is_reached_for_again_from_the_last_point_solved(
    told: dict[str, Any], tmp_path: Path
) -> None:
    """Two go well, one ends at its iteration limit; with no retry left the next one goes on from there."""
    case = compose_any("+scenario=mpcc_file", f"scenario.path={stored(told, tmp_path / 'small.json')}")
    solver = Stuck(["solved", "solved", "iteration_limit", "iteration_limit", "solved"])
    path = Schedule((1.0, 0.1, 0.01), retries=1)
    homotopy(case.scenario.mpcc(), replace(case, solver=solver), Ledger(60.0), "stuck", path=path)
    assert solver.starts[1:] == [1, 2, 2, 4]


def test_derivatives_of_a_whole_problem_are_casadis_own(nosbench: Path) -> None:
    path = nosbench / f"{QUICK[0]}.json.gz"
    mpcc = MpccFile(path).mpcc()
    told = json.loads(gzip.decompress(path.read_bytes()))
    program = assemble(Mpcc(mpcc.variables, mpcc.constraints, mpcc.costs), "never")
    w, p = ca.SX.sym("w", mpcc.size), ca.DM(told["p0"])
    x = np.random.default_rng(0).uniform(0.1, 1.0, mpcc.size)
    g, f = (ca.Function.deserialize(told[k])(w, p) for k in ("g_fun", "augmented_objective_fun"))
    expected = ca.Function("d", [w], [ca.jacobian(g, w), ca.gradient(f, w)])(x)
    np.testing.assert_allclose(ca.densify(program.jacobian(x, 0.0)[1]), ca.densify(expected[0]), atol=1e-12)
    np.testing.assert_allclose(
        np.asarray(program.gradient(x, 0.0)[1]).ravel(), np.asarray(expected[1]).ravel(), atol=1e-12
    )
    assert program.jacobian.sparsity_out(1).nnz() < 0.1 * mpcc.size * g.numel()
