"""The record: the one place that says what is stored about a run, with type, unit and meaning.

A change of this table that is more than a new column at the end of its group raises `SCHEMA_VERSION`.
Records of an earlier version stay readable: columns they do not have are empty, and `benchbench.storage.upgrade`
says where those went that are gone.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from benchbench.storage.status import Status

__all__ = ["COLUMNS", "SCHEMA_VERSION", "Column", "Record", "Status", "make_record"]

SCHEMA_VERSION = 3

COUNT = (0, 2**53)
"""What can be counted: iterations, unknowns, nodes. A solver that never ran may tell anything else."""
GRID = (0, 10**8)
SEED = (0, 2**63 - 1)
LONGEST = 10_000_000
"""Characters of a text that are kept."""

Type = Literal["int", "float", "str", "bool", "strings", "numbers"]
Record = dict[str, Any]


@dataclass(frozen=True)
class Column:
    """One column: its type ("strings" is a list of texts, "numbers" are numbers by name), its unit ("" where there is none), its meaning.

    plausible  smallest and largest number of an "int" that can be true
    """

    name: str
    type: Type
    unit: str
    meaning: str
    plausible: tuple[int, int] = COUNT


COLUMNS: tuple[Column, ...] = (
    # who
    Column("schema_version", "int", "", "version of this table when the record was made"),
    Column("run_id", "str", "", "unique name of the run, also the name of its row and folder"),
    Column("config_hash", "str", "", "hash of the composed configuration; equal hash means the same run"),
    Column("scenario", "str", "", "name of the scenario"),
    Column("vehicle", "str", "", "name of the vehicle model"),
    Column("dynamics", "str", "", "name of the transcription"),
    Column("relaxation", "str", "", "name of the relaxation of the complementarity pairs"),
    Column("solver", "str", "", "name of the solver"),
    Column("strategy", "str", "", "name of the strategy (what is done with several solves)"),
    Column("guess", "str", "", "name of the initial guess"),
    Column("intervals", "int", "", "N, number of intervals of the time grid", GRID),
    Column("kappa_init", "int", "", "number of consecutive nodes asked to be in contact", GRID),
    Column("seed", "int", "", "seed of every random number of the run", SEED),
    Column("task_hash", "str", "", "hash of task, limits, transcription and grid, of a ready-made MPCC of its content and limits; equal "
        "hash means results may be compared"),
    # how it ended
    Column("status", "str", "", "typed outcome: " + ", ".join(Status)),
    Column("claimed_success", "bool", "", "the solver says it succeeded"),
    Column("certified", "bool", "", "the certificate accepts the plan; of an MPCC that is no flight: feasible and complementary, which says "
        "nothing of stationary or bounded, see b_stationary"),
    Column("reasons", "strings", "", "why the plan is not certified, or why there is none; empty if certified"),
    Column("advice", "str", "", "what to change so that a rejected plan may be certified; empty if certified"),
    # what was found
    Column("travel_time_s", "float", "s", "travel time t_N of the plan"),
    Column("objective", "float", "", "value of the cost: t_N + c_u sum h |u - u_ref|^2, own cost terms added; of a ready-made MPCC its own cost"),
    Column("lower_bound_s", "float", "s", "proved lower bound of the travel time"),
    Column("limited_by", "str", "", "demand that lower_bound_s comes from; empty where a kind of scenario does not say"),
    Column("level_bound_s", "float", "s", "lower bound for flights whose nose is turned by the yaw torque alone, not by rolling and "
        "pitching: no proof for others"),
    Column("search", "str", "", "what a strategy that tries candidates tried and proved; empty for others"),
    Column("starts", "int", "", "starts that strategy=multistart solved from; empty for others"),
    Column("starts_certified", "int", "", "how many of them ended with a certified plan"),
    Column("starts_low", "float", "", "lower end of the 95 % Wilson interval of that rate"),
    Column("starts_high", "float", "", "upper end of the 95 % Wilson interval of that rate"),
    Column("optima", "strings", "", "distinct optima that the starts found, the best first"),
    Column("refinement", "strings", "", "what each round of strategy=auto, or each grid of strategy=refine, gave; empty for others"),
    Column("conflict", "str", "", "what conflicts most where strategy=auto found no feasible plan, no proof; empty otherwise"),
    Column("best_known_s", "float", "s", "best certified travel time known for this task_hash when the run began, rewards taken off"),
    Column("gap_percent", "float", "%", "how far a certified plan is above best_known_s, its rewards taken off; negative: it beats it; of a "
        "ready-made MPCC above best_known_objective, in units of its amount (of 1 where that is below 1e-3)"),
    Column("best_known_objective", "float", "", "best certified objective known for this task_hash when the run began, of a ready-made MPCC"),
    Column("published_objective", "float", "", "published optimum of a ready-made MPCC, of the whole problem where this is a discretised "
        "one; empty where none is known"),
    Column("published_source", "str", "", "where it is published"),
    # what it cost
    Column("iterations", "int", "", "solver iterations, summed over all solves of the run"),
    Column("evaluations", "int", "", "calls of objective, constraints and their derivatives, summed over all solves"),
    Column("build_cpu_s", "float", "s", "CPU time to build the problem, compiler included"),
    Column("solve_cpu_s", "float", "s", "CPU time inside the solver, summed over all solves of the run"),
    Column("certificate_cpu_s", "float", "s", "CPU time to check the plan"),
    Column("wall_s", "float", "s", "wall-clock time of the whole run"),
    Column("repeats", "int", "", "how often the run was solved again for its times, after it was solved once for its plan"),
    Column("build_cpu_median_s", "float", "s", "median CPU time of the builds of the repeats"),
    Column("solve_cpu_median_s", "float", "s", "median CPU time of the solves of the repeats"),
    Column("solve_cpu_low_s", "float", "s", "smallest CPU time of the solves of the repeats"),
    Column("solve_cpu_high_s", "float", "s", "largest CPU time of the solves of the repeats"),
    Column("reference_cpu_s", "float", "s", "CPU time of a fixed reference solve beside the repeats, which tells a loaded or slow machine "
        "from slow code; empty without repeats"),
    Column("peak_memory_mb", "float", "MB", "largest resident memory of the run's process (1 MB = 10^6 bytes)"),
    Column("derivatives_cpu_s", "float", "s", "part of build_cpu_s: derivatives of the blocks, taken, compiled or read from the cache"),
    Column("interpreted_blocks", "int", "", "blocks that could not be compiled and stayed interpreted: no compiler, it failed, or half of "
        "time_limit was not enough for it"),
    Column("functions_cpu_s", "float", "s", "part of solve_cpu_s: objective, constraints and their derivatives evaluated; empty where the "
        "solver does not tell"),
    Column("linear_algebra_cpu_s", "float", "s", "the rest of solve_cpu_s: linear algebra and the method's own steps; empty where the solver does not tell"),
    Column("guess_cpu_s", "float", "s", "part of solve_cpu_s: solves that only made the initial guess"),
    Column("homotopy_cpu_s", "float", "s", "part of solve_cpu_s: solves between the guess and the last one, the earlier steps of sigma"),
    # how large it was
    Column("n_variables", "int", "", "number of scalar unknowns of the MPCC"),
    Column("n_constraints", "int", "", "number of scalar constraints of the MPCC, pairs not counted"),
    Column("n_pairs", "int", "", "number of scalar complementarity or vanishing pairs of the MPCC"),
    Column("mpcc_hash", "str", "", "hash of the MPCC; equal hash means solvers got the same problem"),
    # certificate: residuals of the original problem
    Column("max_violation", "float", "scaled", "largest violation of bounds and constraints of the MPCC"),
    Column("max_complementarity", "float", "scaled", "largest residual of the pairs of the MPCC"),
    Column("max_product", "float", "scaled", "largest product G H of a pair of the MPCC; for a vanishing pair with max(H, 0)"),
    Column("kkt_residual", "float", "", "largest component of the MPCC's Lagrangian gradient, multipliers re-estimated, over max(1, |cost gradient|)"),
    Column("stationarity", "str", "", "strongest class of stationarity proved: S, M, C, W, none or undecided; empty where it was not asked"),
    Column("b_stationary", "str", "", "the linearised MPCC has no descent direction: yes, no or undecided; empty where it was not asked"),
    # certificate: replay of the inputs on the independent plant
    Column("replay_defect_position_m", "float", "m", "largest position error after one interval, replay restarted at each node"),
    Column("replay_defect_angle_rad", "float", "rad", "largest angle error after one interval, replay restarted at each node"),
    Column("replay_drift_position_m", "float", "m", "largest position error at a node of the open-loop replay of the whole plan; races: since the gate before"),
    Column("replay_end_error_m", "float", "m", "position error at the end of the open-loop replay"),
    Column("max_rate_ratio", "float", "", "largest |velocity| / limit in the replay, also between nodes"),
    # certificate: contact audit
    Column("contact_start_s", "float", "s", "start of the first contact window"),
    Column("contact_end_s", "float", "s", "end of the last contact window"),
    Column("contact_steps", "int", "", "consecutive nodes at which every contact condition holds; the fewest of all stops"),
    Column("contact_duration_s", "float", "s", "length of the contact window; the shortest of all stops"),
    Column("contact_gaps", "numbers", "its own", "largest gap of each contact condition in the windows (of a path condition all the time), "
        "by its name, in the unit of its limit"),
    Column("contact_gaps_said", "strings", "", "the same in words, with units"),
    Column("touch_speed_mps", "float", "m/s", "relative speed on the replay where the end effector first comes within the magnet's reach of "
        "the ball; of all stops the fastest"),
    Column("touch_before_s", "float", "s", "how long before the contact window that is, 0 inside it"),
    Column("passage_m", "float", "m", "how deep the end effector passes through the ball or its stand before the window, 0 outside"),
    Column("limits_used", "numbers", "1", "share of each kind of limit and tolerance of the certificate that the plan uses, where it keeps it"),
    Column("limits_used_said", "strings", "", "those of which half or more is used, in words, the fullest first"),
    Column("stops", "strings", "", "stops made, in order of time, each with start and end of its contact"),
    Column("reward_s", "float", "s", "rewards of the optional stops made, to be taken off the travel time"),
    Column("costs", "numbers", "s", "own cost terms of the scenario, each integrated over the replay, by name; to be added to the travel time"),
    # certificate: races
    Column("gates", "int", "", "gates of a race before its end"),
    Column("gates_passed", "int", "", "gates passed in order on the replay"),
    Column("gate_worst_miss_m", "float", "m", "largest distance beyond a gate's edge on the replay, negative inside"),
    # flights of the plan in closed loop
    Column("flights", "int", "", "flights of the plan against a world; empty where none was asked for or the plan is not certified"),
    Column("flights_succeeded", "int", "", "how many of them handed over as conf/certificate/flight.yaml asks"),
    Column("flights_low_exact", "float", "", "exact one-sided 95 % lower bound of that rate (Clopper and Pearson)"),
    Column("flights_low", "float", "", "lower end of the 95 % Wilson interval of that rate"),
    Column("flights_high", "float", "", "upper end of the 95 % Wilson interval of that rate"),
    Column("flight_reasons", "numbers", "", "how many flights failed for each reason; a flight may have several"),
    Column("flight_error_before_m", "float", "m", "median over flights: root mean square position error before the ball is within reach"),
    Column("flight_error_after_m", "float", "m", "median over flights: the same from the attachment to the end"),
    Column("flight_touch_p50_mps", "float", "m/s", "median over flights: speed of the end effector relative to the ball where the magnet begins to act"),
    Column("flight_touch_p95_mps", "float", "m/s", "95th percentile of the same"),
    Column("controller_cpu_p50_s", "float", "s", "median CPU time of a command of the controller"),
    Column("controller_cpu_p99_s", "float", "s", "99th percentile of the same"),
    Column("real_time_factor", "float", "", "median over flights: simulated seconds per CPU second of the whole loop"),
    Column("world", "str", "", "name of the world that was flown in"),
    Column("controller", "str", "", "name of the controller"),
    Column("autopilot", "str", "", "name of the autopilot"),
    Column("residual", "str", "", "name of the model of the residual acceleration"),
    Column("payload", "str", "", "name of how the controller knows what it carries"),
    Column("mismatch", "str", "", "name of the ranges by which the world differs from the model"),
    Column("rig", "str", "", "name of the motors, ball and magnet of the world"),
    Column("predictor", "str", "", "name of how the target's motion is predicted; known: as the scenario says"),
    Column("replans", "int", "", "plans made in the loop, of all flights; empty where the target is known"),
    Column("replans_refused", "int", "", "how many of them were none: not solved, or longer than a flight may be"),
    Column("replan_cpu_p50_s", "float", "s", "median CPU time of predicting and planning once, by one thread"),
    Column("replan_cpu_p99_s", "float", "s", "99th percentile of the same"),
    # provenance
    Column("benchbench_version", "str", "", "version of BenchBench"),
    Column("python_version", "str", "", "version of Python"),
    Column("casadi_version", "str", "", "version of CasADi"),
    Column("numpy_version", "str", "", "version of NumPy"),
    Column("solver_version", "str", "", "version of the solver, as its plugin reports it"),
    Column("platform", "str", "", "operating system and machine type"),
    Column("cpu", "str", "", "model name of the processor"),
    Column("cpu_count", "int", "", "number of logical processors the run may use", GRID),
    Column("threads", "int", "", "OMP_NUM_THREADS of the run; empty if not set", GRID),
    Column("git_commit", "str", "", "commit of the BenchBench checkout; empty for an installed package"),
    Column("git_dirty", "bool", "", "the checkout had changes that are not in that commit"),
    Column("source_hash", "str", "", "hash of the source of BenchBench and of the installed plugins"),
    Column("started_at", "str", "", "start of the run, UTC, ISO 8601"),
)  # fmt: skip

_BY_NAME = {column.name: column for column in COLUMNS}


def make_record(**values: Any) -> Record:
    """Return a record with every column, in order; what is not given is None.

    NaN, infinity and counts that cannot be true become None (unknown), NumPy scalars become Python numbers, text what
    UTF-8 can say of it, up to `LONGEST` characters. Raises TypeError for a name that is no column or a value of the wrong type, ValueError
    for a status that does not exist.
    """
    unknown = sorted(values.keys() - _BY_NAME.keys())
    if unknown:
        raise TypeError(f"not a column of the record: {', '.join(unknown)}; see benchbench/storage/schema.py")
    values.setdefault("schema_version", SCHEMA_VERSION)
    record: Record = dict.fromkeys(_BY_NAME)
    for name, value in values.items():
        if value is not None:
            column = _BY_NAME[name]
            record[name] = value if _is_plain(column.type, value) else _convert(column, value)
    if record["status"] not in (None, *Status):
        raise ValueError(f"there is no status {record['status']!r}; see benchbench/storage/status.py")
    return record


def _is_plain(type_: Type, value: Any) -> bool:
    """Whether a value may stand as it is; most do, and this is what large tables spend their time on."""
    if type_ == "float":
        return type(value) is float and value - value == 0.0  # neither infinite nor NaN
    return type_ == "str" and type(value) is str and value.isascii() and len(value) <= LONGEST


def _convert(column: Column, value: Any) -> Any:
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    type_ = column.type
    if not _fits(type_, value):
        raise TypeError(f"record column {column.name} is {type_}, got {value!r}")
    if type_ == "float":
        return float(value)
    if type_ == "str":
        return _text(value)
    if type_ == "strings":
        return [_text(text) for text in value]
    if type_ == "numbers":
        return {_text(name): _number(number) for name, number in value.items()}
    if type_ == "int":
        low, high = column.plausible
        return value if low <= value <= high else None
    return value


def _text(value: str) -> str:
    """Text that every file can hold: a lone surrogate cannot be written."""
    return str(value)[:LONGEST].encode("utf-8", "replace").decode()


def _number(value: Any) -> float | None:
    return float(value) if value is not None and math.isfinite(value) else None


def _fits(type_: Type, value: Any) -> bool:
    if type_ == "float":
        return isinstance(value, float) or _fits("int", value)
    if type_ == "str":
        return isinstance(value, str)
    if type_ == "int":
        return isinstance(value, int) and not isinstance(value, bool)
    if type_ == "bool":
        return isinstance(value, bool)
    if type_ == "strings":
        return isinstance(value, list | tuple) and all(isinstance(text, str) for text in value)
    return isinstance(value, Mapping) and all(
        isinstance(name, str) and (number is None or _fits("float", number)) for name, number in value.items()
    )
