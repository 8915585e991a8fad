"""The end of a search for the fastest plan that succeeds: the front, as text, table and picture."""

from __future__ import annotations

import csv
import io
import shlex
from collections.abc import Iterator, Sequence
from dataclasses import replace
from datetime import datetime
from pathlib import Path

from benchbench.analysis.front import Candidate, elsewhere, fastest, front, paired
from benchbench.run.fitting import on_terminal, width
from benchbench.run.overrides import keys
from benchbench.run.settings import NOT_DECISIVE
from benchbench.storage.files import write_bytes
from benchbench.sweep.rows import candidates
from benchbench.sweep.sweep import Swept

FOLDER = "robust"
"""In the folder of results."""
TARGET = 0.95
"""Where a run says none."""
COLUMNS = (
    "travel_time_s", "flights", "succeeded", "proved", "wilson_low", "wilson_high", "failed",
    "elsewhere_flights", "elsewhere_succeeded", "elsewhere_proved", "front", "chosen", "overrides",
)  # fmt: skip
NAMED = ("scenario", "controller", "autopilot", "residual", "mismatch")
"""What the title of the picture says, where all plans have the same."""


def conclude(searched: bool, swept: Sequence[Swept]) -> None:
    """Print the front of what was flown, and write it; raises BadInput where it cannot be written.

    searched: whether the best were flown in other worlds, too.
    """
    flown = [replace(one, overrides=_told(one.overrides)) for one in candidates(swept)]
    found = sorted(paired(flown) if searched else flown, key=lambda one: one.travel_time)
    root = next((one.place.root for one in swept if one.place), None)
    if root is None or not found:
        print("no certified plan was flown")
        return
    target = next((float(said) for one in swept if (said := _said(one.overrides, "target_success"))), TARGET)
    best, chosen = front(found), fastest(found, target)
    print(*_shown(found, best, chosen), sep="\n")
    print(
        f"front        {len(best)} plans of {len(found)}, marked * and ->: none of the others is faster and succeeds as often"
    )
    path = root / FOLDER / f"{datetime.now():%Y-%m-%d_%H-%M-%S-%f}.csv"
    write_bytes(path, _table(found, best, chosen).encode())
    _draw(path.with_suffix(".png"), found, target)
    print(f"             {path}\n             {path.with_suffix('.png')}")
    if chosen is None:
        print(
            f"no plan proves {100 * target:g} %: more flights (flights=...), or gentler plans (a smaller slope)"
        )
        return
    print(
        f"fastest      {chosen.travel_time:.4f} s of those that prove {100 * target:g} %, marked ->; {_elsewhere(chosen)}"
    )
    print(f"             python -m benchbench {shlex.join(elsewhere((chosen.again or chosen).overrides))}")


def _elsewhere(one: Candidate) -> str:
    """Whether it was lucky in its worlds, and what the command is for that follows."""
    if one.again is None:
        return "to see whether it was lucky in its worlds, fly it in others:"
    return f"{one.again.succeeded} of {one.again.flights} in worlds that it was not chosen by, {100 * one.again.low:.1f} % proved; in others:"


def _draw(path: Path, found: Sequence[Candidate], target: float) -> None:
    from benchbench.report.front import draw_front

    common = [text for text in found[0].overrides if all(text in one.overrides for one in found)]
    said = [name for group in NAMED if (name := _said(common, group))]
    title = f"What success costs: {', '.join(said)}"
    draw_front(
        path, found, target, title, lambda one: " ".join(map("=".join, _differing(one, found).items()))
    )


def _told(overrides: Sequence[str]) -> tuple[str, ...]:
    """Overrides that say what is flown, not where results go or how many run at once."""
    return tuple(text for text in overrides if not keys([text]) & set(NOT_DECISIVE))


def _differing(one: Candidate, found: Sequence[Candidate]) -> dict[str, str]:
    """What it was asked for that not all others were, by field without the scenario's own name before it."""
    common = set.intersection(*(set(other.overrides) for other in found))
    told = (text.lstrip("+").partition("=") for text in one.overrides if text not in common)
    return {key.removeprefix("scenario.").removeprefix("contacts."): value for key, _, value in told}


def _said(overrides: Sequence[str], field: str) -> str:
    """The value that overrides give a field; "" without one."""
    return next(
        (text.partition("=")[2] for text in overrides if text.lstrip("+").startswith(f"{field}=")), ""
    )


def _failed(one: Candidate) -> str:
    often = sorted(one.reasons.items(), key=lambda pair: -pair[1])
    return ", ".join(f"{name} {count}" for name, count in often)


def _shown(found: Sequence[Candidate], best: Sequence[Candidate], chosen: Candidate | None) -> Iterator[str]:
    """Lines of a table; on a terminal only what fits, the file has all."""
    fields = list(dict.fromkeys(field for one in found for field in _differing(one, found)))
    twice = any(one.again for one in found)
    rows = [("", "travel time", "succeed", "proved", *(("elsewhere",) if twice else ()), *fields)]
    for one in found:
        mark, has = "->" if one is chosen else " *" if one in best else "  ", _differing(one, found)
        told = (f"{one.travel_time:.4f} s", f"{one.succeeded} of {one.flights}", f"{100 * one.low:.1f} %")
        there = f"{one.again.succeeded} of {one.again.flights}" if one.again else ""
        rows.append((mark, *told, *((there,) if twice else ()), *(has.get(field, "") for field in fields)))
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row, why in zip(rows, ("why others fail", *map(_failed, found)), strict=True):
        line = "  ".join((*(text.rjust(size) for text, size in zip(row, widths, strict=True)), why)).rstrip()
        yield line[: width()] if on_terminal() else line


def _table(found: Sequence[Candidate], best: Sequence[Candidate], chosen: Candidate | None) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for one in found:
        there = (one.again.flights, one.again.succeeded, one.again.low) if one.again else ("", "", "")
        writer.writerow(
            [
                one.travel_time, one.flights, one.succeeded, one.low, *one.interval, _failed(one), *there, one in best,
                one is chosen, shlex.join(one.overrides),
            ]
        )  # fmt: skip
    return text.getvalue()
