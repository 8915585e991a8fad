"""What the program says: the summary of a run, made to be read in ten seconds."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from os.path import commonpath
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from benchbench.ground.families import FLOWN
from benchbench.run.wording import above, near, number, scaled
from benchbench.storage.best_known import SAME
from benchbench.storage.schema import Status

THROUGH = 5e-5
"""Depth in m below which a passage through the ball is not worth a word."""
ONE_LINE = 64
"""Characters of choices and size that stand in one line of a terminal's 80 columns."""
USES = 2
"""How many of the fullest limits are named."""
REASONS = 4
"""Reasons against a plan that are shown; the record has all."""


def show(record: Mapping[str, Any], paths: Mapping[str, Path], console: Console | None = None) -> None:
    """Print the summary of a record and the paths of what was written."""
    console = console or Console(highlight=False)
    grid = Table.grid(padding=(0, 2))
    grid.add_column(style="bold", no_wrap=True, min_width=11)
    grid.add_column(overflow="fold")
    for name, text in lines(record):
        grid.add_row(name, text)
    console.print(grid)
    if new_best(record) and "record" in paths:
        folder = shlex.quote(near(paths["record"].parent))
        console.print(
            Text(f"{'keep it':<13}", style="bold") + Text(f"benchbench best {folder}"), soft_wrap=True
        )
    for name, place in _places(paths).items():
        console.print(Text(f"{name:<13}", style="bold") + Text(place, style="not bold"), soft_wrap=True)


def lines(r: Mapping[str, Any]) -> list[tuple[str, Text | str]]:
    """What is said of a record: a name and a text, which may have several lines, for each row."""
    choices = " / ".join(
        str(r[k]) for k in ("vehicle", "dynamics", "relaxation", "solver", "strategy", "guess") if r[k]
    )
    size = _size(r)
    times = (r["build_cpu_s"], r["solve_cpu_s"], r["certificate_cpu_s"])
    build, solve, check = (number(value, ".2f", "s") for value in times)
    return [
        (str(r["scenario"]), f"{choices}{'; ' if len(choices) + len(size) < ONE_LINE else chr(10)}{size}"),
        ("verdict", _verdict(r)),
        *(_flight(r) if flies(r) else _solution(r)),
        *_flown(r),
        ("effort", f"{r['iterations']} iterations; CPU build {build}, solve {solve}, check {check}"),
    ]


def flies(r: Mapping[str, Any]) -> bool:
    """A flight has a time grid; a ready-made MPCC has none."""
    return r["intervals"] is not None


def _solution(r: Mapping[str, Any]) -> list[tuple[str, Text | str]]:
    """What there is to say of the solution of an MPCC that is no flight."""
    residuals = (f"{number(r['max_violation'], '.1e', '')}violated, "
                 f"largest product of a pair {number(r['max_product'], '.1e', '')}")  # fmt: skip
    lines: list[tuple[str, Text | str]] = [("objective", f"{number(r['objective'], '.8g', '')}{_known(r)}")]
    if r["published_objective"] is not None:
        lines.append(("published", f"{r['published_objective']:.8g}: {r['published_source']}"))
    if new_best(r):
        lines.append(_new_best(r, "than any certified solution before"))
    lines.append(("residuals", residuals))
    if r["stationarity"] is not None:
        text = f"{r['stationarity']}, B-stationary: {r['b_stationary']}"
        lines.append(("stationary", f"{text} (KKT residual {number(r['kkt_residual'], '.1e', '')})"))
    return lines


def _flight(r: Mapping[str, Any]) -> list[tuple[str, Text | str]]:
    lines: list[tuple[str, Text | str]] = [
        ("travel time", f"{number(r['travel_time_s'], '.4f', 's')}   "
                        f"(lower bound {number(r['lower_bound_s'], '.3f', 's')}{_best(r)})"),
        *_limited(r),
    ]  # fmt: skip
    if new_best(r):
        lines.append(_new_best(r, "than any certified plan before"))
    if r["costs"]:
        lines.append(("costs", _costs(r["costs"])))
    if r["contact_start_s"] is not None:
        lines.append(("contact", f"{_contacts(r)}\n{_worst(r)}"))
    if r["touch_speed_mps"] is not None:
        lines.append(("magnet", _touch(r)))
    if r["search"]:
        lines.append(("search", r["search"]))
    if len(r["refinement"] or ()) > 1:
        lines.append(("grids", "\n".join(r["refinement"])))
    if r["starts"]:
        certified = f"{r['starts_certified']} of {r['starts']} certified"
        interval = f"{100 * r['starts_low']:.0f} to {100 * r['starts_high']:.0f} %"
        lines.append(("starts", "\n".join((f"{certified} (95 % interval {interval})", *r["optima"]))))
    if r["gates"] is not None:
        lines.append(("gates", f"{r['gates_passed']} of {r['gates']} in order{_nearest(r)}"))
    defect, drift = (scaled(r[f"replay_{k}_position_m"], 1e3, "mm") or "-" for k in ("defect", "drift"))
    lines.append(("replay", f"{defect} off after one interval, {drift} at worst flown open loop{_far(r)}"))
    if r["certified"] and r["limits_used_said"]:
        lines.append(("limits used", "\n".join(r["limits_used_said"][:USES])))
    return lines


def _costs(costs: Mapping[str, float | None]) -> str:
    """The own cost terms of a scenario, which count beside the travel time."""
    return ", ".join(f"{name} {number(value, '.4f', 's')}" for name, value in costs.items())


def _limited(r: Mapping[str, Any]) -> list[tuple[str, Text | str]]:
    """The demand that bounds the travel time, and yaw where that takes longer."""
    proved, level, by = r["lower_bound_s"], r["level_bound_s"], r["limited_by"]
    if not by:
        return []
    if level is None or level <= 1.01 * proved:
        return [("limited by", by)]
    return [("limited by", f"yaw, at least {level:.3f} s by its torque (no proof)\nproved: {by}")]


def _flown(r: Mapping[str, Any]) -> list[tuple[str, Text | str]]:
    """How the plan fared in closed loop."""
    if r["flights"] is None:
        return []
    proved = f"at least {100 * r['flights_low_exact']:.1f} % proved at 95 %, Wilson {100 * r['flights_low']:.0f} to {100 * r['flights_high']:.0f} %"
    how = " / ".join(str(r[name]) for name in FLOWN)
    failures = sorted((r["flight_reasons"] or {}).items(), key=lambda item: (-item[1], item[0]))
    said = [
        f"{r['flights_succeeded']} of {r['flights']} succeed: {proved}",
        *([", ".join(f"{name}: {count:g}" for name, count in failures)] if failures else []),
        f"{how}",
        f"tracking {scaled(r['flight_error_before_m'], 1e3, 'mm') or '-'} before, "
        f"{scaled(r['flight_error_after_m'], 1e3, 'mm') or '-'} after the ball is taken; "
        f"touch {scaled(r['flight_touch_p50_mps'], 1, 'm/s') or '-'}, p95 {scaled(r['flight_touch_p95_mps'], 1, 'm/s') or '-'}",
        f"controller CPU p50 {scaled(r['controller_cpu_p50_s'], 1e3, 'ms') or '-'}, p99 "
        f"{scaled(r['controller_cpu_p99_s'], 1e3, 'ms') or '-'}; {scaled(r['real_time_factor'], 1, 'times real time') or '-'}",
    ]
    return [("flights", "\n".join(said))]


def _nearest(r: Mapping[str, Any]) -> str:
    """How near to an edge, or how far outside, the gate is passed that is passed worst; the end is one, too."""
    miss = r["gate_worst_miss_m"]
    if miss is None:
        return ""
    far = f"{1e3 * abs(miss):.3g} mm" if abs(miss) < 1 else f"{abs(miss):.3g} m"
    if miss <= 0:
        return f", {far} inside the edge at the tightest"
    if r["gates_passed"] == r["gates"] and any(reason.startswith("the end is ") for reason in r["reasons"]):
        return f", but the end is missed by {far}"
    return f", {far} outside the edge at worst"


def new_best(r: Mapping[str, Any]) -> bool:
    """The run has a certified plan that beats the best known one."""
    return r["gap_percent"] is not None and r["gap_percent"] < -100 * SAME


def _new_best(r: Mapping[str, Any], than: str) -> tuple[str, Text]:
    return "new best", Text(f"{-r['gap_percent']:.2g} % less {than}", style="bold green")


def _best(r: Mapping[str, Any]) -> str:
    if r["best_known_s"] is None:
        return ""
    less = ", rewards taken off," if r["reward_s"] else ", costs added," if r["costs"] else ""
    return f"; best known{less} {r['best_known_s']:.4f} s{_above(r)}"


def _known(r: Mapping[str, Any]) -> str:
    best = r["best_known_objective"]
    return "" if best is None else f"  (best known {best:.8g}{_above(r)})"


def _above(r: Mapping[str, Any]) -> str:
    """How far above the best known value."""
    return "" if r["gap_percent"] is None else f", {above(r['gap_percent'])}"


def _size(r: Mapping[str, Any]) -> str:
    if not flies(r):
        return f"{r['n_variables']} unknowns, {r['n_constraints']} constraints, {r['n_pairs']} pairs"
    asked = "" if r["kappa_init"] is None else f", kappa_init = {r['kappa_init']}"
    return f"N = {r['intervals']}{asked}"


def _far(r: Mapping[str, Any]) -> str:
    return "" if r["gates"] is None else " from gate to gate"


def _contacts(r: Mapping[str, Any]) -> str:
    """When each stop is made, or the one contact there is."""
    shortest = f"{r['contact_duration_s']:.3f} s, {r['contact_steps']} nodes"
    stops = r["stops"] or ()
    if all(stop.startswith("target ") for stop in stops):  # the only one
        return f"{r['contact_start_s']:.3f} to {r['contact_end_s']:.3f} s: {shortest}"
    worth = f"\nworth {r['reward_s']:g} s" if r["reward_s"] else ""
    return "\n".join(stops) + f"\nat least {shortest}{worth}"


def _worst(r: Mapping[str, Any]) -> str:
    return "at worst " + (", ".join(r["contact_gaps_said"] or ()) or "-")


def _touch(r: Mapping[str, Any]) -> str:
    """How the magnet meets the ball."""
    early = f", {1e3 * r['touch_before_s']:.0f} ms before contact" if r["touch_before_s"] else ""
    depth = r["passage_m"] or 0.0
    through = f"; {1e3 * depth:.1f} mm through ball or stand on the way" if depth > THROUGH else ""
    return f"within reach at {r['touch_speed_mps']:.3g} m/s{early}{through}"


def _verdict(r: Mapping[str, Any]) -> Text:
    if r["certified"]:
        return Text("certified", style="bold green") + _meaning(r)
    claim = "the solver claims success" if r["claimed_success"] else f"the solver ended with {r['status']}"
    if flies(r) and r["n_variables"] is None and r["claimed_success"]:
        claim = f"the plan is by {r['solver']}"
    text = Text(f"NOT certified ({claim})", style="bold red")
    for reason in r["reasons"][:REASONS]:
        text.append(f"\n- {reason}", style="not bold red")
    if len(r["reasons"]) > REASONS:
        text.append(f"\n- and {len(r['reasons']) - REASONS} more, see the record", style="not bold red")
    helps = r["advice"] if r["claimed_success"] else Status[r["status"].upper()].remedy
    if helps:
        text.append(f"\nadvice: {helps}", style="not bold")
    return text


def _meaning(r: Mapping[str, Any]) -> Text:
    """What "certified" says of an MPCC that is no flight: feasible and complementary, which is not yet optimal."""
    if flies(r):
        return Text("")
    text = Text(": feasible and complementary", style="not bold")
    if r["b_stationary"] == "no":
        return text.append(", but NOT stationary: the cost falls from here", style="bold red")
    if r["b_stationary"] != "yes":
        text.append("; whether it is stationary is not known")
    return text


def _places(paths: Mapping[str, Path]) -> dict[str, str]:
    """Folders on a line each, with the names of the files in them."""
    files = [path for path in paths.values() if path.is_file()]
    folders = [path for path in paths.values() if not path.is_file()]
    together = Path(commonpath([path.parent for path in files])) if files else None
    shown = {"files": near(together), "": " ".join(path.name for path in files)} if together else {}
    return shown | ({"table": near(folders[0])} if folders else {})
