"""Certified plans flown under every mismatch: the tables of docs/flight.md.

    OMP_NUM_THREADS=1 python benchmarks/flights.py                    # all tables
    OMP_NUM_THREADS=1 python benchmarks/flights.py residuals --flights 20
    OMP_NUM_THREADS=1 python benchmarks/flights.py robustness --plan +scenario=static +scenario/contact=approach

Each table but `cost` plans once and flies that plan; rows differ in what its name says and share the seeds of the mismatch. What is told
of times is CPU time of one process.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence

from benchbench.flight.columns import columns
from benchbench.planning.case import Case
from benchbench.run import config, pipeline
from benchbench.run.flying import campaign

GENTLE = (
    "+scenario=circle", "+scenario/contact=approach", "scenario.contacts.approach.slope=3", "scenario.contact_seconds=0.1",
)  # fmt: skip
"""A plan that succeeds in 59 of 59 flights under lab with an observer."""
TABLES: dict[str, tuple[tuple[str, ...], ...]] = {
    "perfect": tuple(("residual=none", "mismatch=none", f"autopilot={a}") for a in ("px4", "torque_ff")),
    "residuals": tuple((f"residual={r}",) for r in ("none", "constant", "gp", "observer", "gp_observer")),
    "mismatch": tuple(
        (f"residual={r}", f"mismatch={m}") for r in ("none", "observer", "gp_observer") for m in ("lab", "lab2x", "windy")
    ),
    "payload": tuple(
        (f"residual={r}", f"payload={p}", "mismatch=none", "autopilot=torque_ff", "rig.ball_mass=0.2", "rig.pull=5")
        for r in ("none", "observer")
        for p in ("ignored", "known", "estimated")
    ),
    "iron": tuple(
        (f"residual={r}", f"payload={p}", "mismatch=none", "autopilot=torque_ff", "rig=iron")
        for r in ("none", "observer")
        for p in ("ignored", "known", "estimated")
    ),
    "robustness": tuple(
        ("residual=observer", change)
        for change in (
            "mismatch.delay=[0.03,0.03]", "mismatch.first_motor=[-0.07,-0.07]", "mismatch.target_late=[0.05,0.05]",
            "mismatch.blind=[0.3,0.3]", "mismatch.ball_mass=[0.1,0.1]", "mismatch.gust=[0.424,0.424]",
        )
    ),
    **{
        name: tuple(("residual=observer", f"predictor={p}") for p in ("known", "constant_velocity", "constant_turn", "gp"))
        for name in ("braking", "turning")
    },
}  # fmt: skip
"""Rows of overrides; a gust of 0.424 N along x and along y is one of 0.6 N."""
SLOW = (
    "+scenario/contact=approach", "scenario.contacts.approach.slope=3", "scenario.contact_seconds=0.2", "scenario.aim.position=0.6",
)  # fmt: skip
PLANS = {
    "iron": ("+scenario=hardware_circle", "+scenario/contact=approach", "scenario.aim.position=0.6"),
    "braking": ("+scenario=braking", *SLOW), "turning": ("+scenario=turning", *SLOW),
}  # fmt: skip
"""Plans of tables that are not about `GENTLE`: a ball of 456 g leaves no motor anything on a fast one."""
ONCE = ("perfect", "payload", "iron")
"""Tables whose world is the same in every flight."""
APPROACH, NEARER = "+scenario/contact=approach", "scenario.aim.position=0.6"
COST = (
    (10, "+scenario=circle"), (59, "+scenario=circle", APPROACH, NEARER), (59, *GENTLE),
    (29, "+scenario=hardware_static", APPROACH, NEARER), (29, "+scenario=hardware_circle", APPROACH, NEARER),
    (29, "+scenario=hardware_circle_23", APPROACH, NEARER),
    (29, "+scenario=hardware_circle_23", APPROACH, "scenario.contacts.approach.slope=3", "autopilot=torque_ff"),
)  # fmt: skip
"""What success costs: flights, and the plan that is flown with an observer; 29 without a failure prove 90 %, 59 prove 95 %."""
HEAD = (
    "| what | success | proved | reasons | before mm | after mm | touch p50 / p95 m/s | command p50 / p99 ms | x real time "
    "| plans in the loop, refused; p50 / p99 ms |",
    "|---|---|---|---|---|---|---|---|---|---|",
)


def rows(name: str, plan: Sequence[str], flights: int) -> Iterator[str]:
    """Yield the lines of a Markdown table."""
    case, run = planned(plan)
    yield f"`{' '.join(plan)}`: {run.record['travel_time_s']:.4f} s, {'' if run.certificate.certified else 'NOT '}certified\n"
    yield from HEAD
    for overrides in TABLES[name]:
        asked = (f"flights={1 if name in ONCE else flights}", *overrides)
        yield line(f"`{' '.join(overrides)}`", flown(case, run, *plan, *asked))


def costs() -> Iterator[str]:
    """Yield the lines of the table of what success costs: each row has a plan of its own."""
    yield from HEAD
    for flights, *plan in COST:
        case, run = planned([part for part in plan if not part.startswith("autopilot")])
        told = flown(case, run, *plan, f"flights={flights}", "residual=observer")
        yield line(f"`{' '.join(plan)}`: {run.record['travel_time_s']:.4f} s", told)


def planned(plan: Sequence[str]) -> tuple[Case, pipeline.Run]:
    """Return a case and its certified plan."""
    cfg, chosen = config.composed(*plan)
    case = config.build(cfg, chosen)
    assert isinstance(case, Case)
    return case, pipeline.run(case)


def flown(case: Case, run: pipeline.Run, *overrides: str) -> dict:
    """Fly it as overrides say; return the record's columns."""
    found = campaign(*config.composed(*overrides))
    assert found is not None and run.certificate.flight is not None
    found.check(case.scenario, case.model)
    _, each = found.fly(run.result.plan, run.certificate.flight, case)
    return columns(found, each)


def line(what: str, r: dict) -> str:
    """One row."""

    def number(name: str, factor: float = 1.0, form: str = ".3g") -> str:
        return "-" if r[name] is None else f"{factor * r[name]:{form}}"

    reasons = ", ".join(f"{name} {count}" for name, count in sorted(r["flight_reasons"].items())) or "-"
    return (
        f"| {what} | {r['flights_succeeded']}/{r['flights']} | {100 * r['flights_low_exact']:.1f} % | {reasons} "
        f"| {number('flight_error_before_m', 1e3)} | {number('flight_error_after_m', 1e3)} "
        f"| {number('flight_touch_p50_mps')} / {number('flight_touch_p95_mps')} "
        f"| {number('controller_cpu_p50_s', 1e3)} / {number('controller_cpu_p99_s', 1e3)} | {number('real_time_factor')} "
        f"| {'-' if not r.get('replans') else told_of_plans(r)} |"
    )


def told_of_plans(r: dict) -> str:
    """What was planned in the loop."""
    p50, p99 = 1e3 * r["replan_cpu_p50_s"], 1e3 * r["replan_cpu_p99_s"]
    return f"{r['replans']}, {r['replans_refused']}; {p50:.3g} / {p99:.3g}"


def main() -> None:
    """Print the tables that are asked for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("tables", nargs="*", choices=["cost", *TABLES, []], help="which; all without any")
    parser.add_argument("--flights", type=int, default=40)
    parser.add_argument("--plan", nargs="+")
    asked = parser.parse_args()
    for name in asked.tables or ("cost", *TABLES):
        print(f"\n### {name}\n", flush=True)
        plan = asked.plan or PLANS.get(name, GENTLE)
        for text in costs() if name == "cost" else rows(name, plan, asked.flights):
            print(text, flush=True)


if __name__ == "__main__":
    main()
