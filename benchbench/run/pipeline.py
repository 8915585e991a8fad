"""The whole run, one line per stage: case -> plan -> certificate -> record -> files. Read this first."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchbench.certificate.certificate import Certificate
from benchbench.flight.campaign import Campaign
from benchbench.flight.columns import Flights, flights
from benchbench.nlp.ledger import Ledger, Watch
from benchbench.ocp.airframe import airframe_of
from benchbench.planning import columns
from benchbench.planning.case import AnyCase, Case
from benchbench.planning.result import Result
from benchbench.planning.strategy import judge
from benchbench.planning.validate import validate
from benchbench.storage import convergence, provenance
from benchbench.storage.best_known import BestKnown
from benchbench.storage.best_known import known as best_known


@dataclass(frozen=True)
class Run:
    """What one run found: the plan and its claimed solution, the judgement, the row of the table."""

    case: AnyCase
    result: Result
    certificate: Certificate
    record: dict[str, Any]
    flights: Flights | None = None
    convergence: str = ""
    """Of the solves, as `benchbench.storage.convergence.text` writes it."""


def run(
    case: AnyCase,
    watch: Watch | None = None,
    labels: Mapping[str, Any] | None = None,
    repeats: int = 1,
    known: BestKnown | None = None,
    campaign: Campaign | None = None,
) -> Run:
    """Plan, judge, fly where that is asked, record; raises BadInput for a case that cannot work.

    A flight is posed by its strategy; a ready-made MPCC enters at the waist, and there is no plan in its solution.

    labels: ready columns of the record; repeats: solves to time. The plan is always the first solve's; with
    more than one repeat that one is the warm-up and is not among the timed ones; known: best known values to compare
    with, those that come with BenchBench unless said otherwise; campaign: how a certified plan is flown, None for not at all.
    """
    before = provenance.collect()
    began = time.perf_counter()
    validate(case)
    if campaign:
        campaign.check(getattr(case, "scenario", None), getattr(case, "model", None))
    ledger = Ledger(case.time_limit, watch)
    result = case.plan(ledger)
    timed = [_again(case, watch) for _ in range(repeats)] if repeats > 1 else [ledger]
    if watch:
        watch.stage("certificate", None)
    certificate = judge(result, case, ledger)
    with ledger.judging():
        told = {**case.told(result), **columns.first_order(case, result)}
    costs = {
        "certificate_cpu_s": ledger.judging_cpu,
        "wall_s": time.perf_counter() - began,
        **columns.spread(timed),
    }
    flown = _fly(campaign, case, result, certificate, watch)
    told |= flown.columns if flown else {}
    ready = {**before, **costs, **told, **(labels or {})}
    record = columns.record(case, result, certificate, ledger, ready)
    record |= (known or best_known()).compare(record)
    return Run(case, result, certificate, record, flown, convergence.text(ledger.solves))


def write(done: Run, folder: Path, table: Path, config: str, picture: bool = True) -> dict[str, Path]:
    """Write recording and picture, then the record into `folder`, then the row into `table`; returns the paths.

    What an earlier run left in the folder goes first. A row is there once everything that it promises is; a recording or a
    picture that cannot be made costs neither record nor row. config: the composed configuration as YAML; picture: whether
    to draw. Raises BadInput("output", ...) when the disk refuses.
    """
    from benchbench.storage.files import (
        CONFIG,
        FLIGHTS,
        RECORD,
        vacate,
        write_bytes,
        write_record,
        write_solution,
    )
    from benchbench.storage.table import append

    vacate(folder)
    paths = {"config": folder / CONFIG, "record": folder / RECORD}
    write_bytes(paths["config"], config.encode())
    try:
        if isinstance(done.case, Case):
            paths["plan"] = _write_flight(done, done.case, folder, config)
            if done.flights:
                paths["flights"] = folder / FLIGHTS
                write_bytes(paths["flights"], done.flights.table.encode())
            paths |= {"picture": _draw(done, done.case, folder)} if picture else {}
            paths |= _show_flights(done, done.case, folder, config) if picture else {}
        else:
            solution = done.result.mpcc.split(done.result.solved.x)
            paths["solution"] = write_solution(folder, solution)
    finally:
        write_record(folder, done.record)
        paths["table"] = append(done.record, table).parent
    return paths


def _write_flight(done: Run, case: Case, folder: Path, config: str) -> Path:
    from benchbench.storage.files import PLAN
    from benchbench.storage.recording import write_mcap

    path, flight = folder / PLAN, done.certificate.flight
    more = {convergence.NAME: done.convergence} if done.convergence else {}
    write_mcap(path, done.result.plan, flight, case.scenario, case.model, {"config": config, **more})
    return path


def _draw(done: Run, case: Case, folder: Path) -> Path:
    from benchbench.report.caption import caption
    from benchbench.report.picture import draw
    from benchbench.storage.files import PICTURE

    path, plan, flight = folder / PICTURE, done.result.plan, done.certificate.flight
    draw(path, plan, case.scenario, case.model, flight, *caption(done.record))
    return path


def _show_flights(done: Run, case: Case, folder: Path, config: str) -> dict[str, Path]:
    """The picture of all flights, and a recording of the one to look at: the first that failed, else the first."""
    if done.flights is None:
        return {}
    from benchbench.flight.recording import write_flight
    from benchbench.report.flights import draw_flights
    from benchbench.storage.files import FLIGHT, FLIGHTS_PICTURE

    flights, paths = done.flights, {"flights_picture": folder / FLIGHTS_PICTURE, "flight": folder / FLIGHT}
    told = flights.columns
    why = ", ".join(f"{reason} {count}" for reason, count in told["flight_reasons"].items())
    title = f"{told['flights_succeeded']} of {told['flights']} flights succeed{f' ({why})' if why else ''}: "
    title += (
        f"{case.scenario.name}, {flights.reference.travel_time:.3f} s, {told['residual']}, {told['mismatch']}"
    )
    draw_flights(
        paths["flights_picture"], flights.reference, flights.flown, flights.airframe, flights.limits, title
    )
    one = next((one for one in flights.flown if not one.verdict.success), flights.flown[0])
    write_flight(paths["flight"], one.reference, one, case.scenario, case.model, {"config": config})
    return paths


def _fly(
    campaign: Campaign | None, case: AnyCase, result: Result, certificate: Certificate, watch: Watch | None
) -> Flights | None:
    """Fly a certified plan; there is nothing to be learned from flying another one."""
    if (
        campaign is None
        or not isinstance(case, Case)
        or not certificate.certified
        or certificate.flight is None
    ):
        return None

    def hear(number: int, count: int) -> None:
        if watch:
            watch.stage(f"flight {number} of {count}", None)

    reference, flown = campaign.fly(result.plan, certificate.flight, case, hear)
    return flights(campaign, airframe_of(case.model), reference, flown)


def _again(case: AnyCase, watch: Watch | None) -> Ledger:
    """Solve once more, for its times."""
    ledger = Ledger(case.time_limit, watch, repeated=True)
    case.plan(ledger)
    return ledger
