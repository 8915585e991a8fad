"""Runs of folders and bundles of one or several machines as one table, and whose word each verdict is."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from benchbench.run.recertify import REFUSED, Anew, recertify
from benchbench.storage.bundle import Bundle, is_bundle, machine_name, opened
from benchbench.storage.collect import collect
from benchbench.storage.schema import Record, Status
from benchbench.storage.table import table_of

if TYPE_CHECKING:
    import pyarrow as pa

RECORDED = "as recorded there"


@dataclass(frozen=True)
class Gathered:
    """All runs; the sequences are as long as the table.

    rows      what a bundle says of its runs is corrected where a plan was judged anew
    folders   of each run, None where only its row is left; those of bundles are gone when the context ends
    problems  files that could not be used
    machines  what the machine of each run is called
    whose     whose word the verdict on each run is
    anew      what judging each plan again gave, None where it was not judged again
    sources   the path that was given, of each run
    """

    rows: pa.Table
    folders: tuple[Path | None, ...]
    problems: dict[Path, str]
    machines: tuple[str, ...]
    whose: tuple[str, ...]
    anew: tuple[Anew | None, ...]
    sources: tuple[str, ...]

    @property
    def said(self) -> str:
        """What was certified anew, in one line, "" where nothing was to be."""
        seen = [one for one in self.anew if one is not None]
        if not seen:
            return ""
        counts = {
            "certified anew here": sum(one.certified is True for one in seen),
            "refused here": sum(one.certified is False and one.said != REFUSED for one in seen),
            REFUSED: sum(one.said == REFUSED for one in seen),
            "without a plan that can be judged here": sum(one.certified is None for one in seen),
        }
        parts = ", ".join(f"{count} {what}" for what, count in counts.items() if count)
        return f"{len(seen)} runs judged again: {parts}"


@contextmanager
def gathered(
    places: Sequence[Path], hear: Callable[[str], None], everything: bool = False, trust: bool = False
) -> Iterator[Gathered]:
    """Open bundles, verified, read all runs, and judge again the plans of bundles.

    everything: judge those of folders, too; trust: judge none again. Raises BadInput for a folder that is not there, or a
    bundle that is none, cut off or changed.
    """
    with ExitStack() as stack:
        bundles = {
            place: stack.enter_context(opened(place, hear)) for place in dict.fromkeys(places) if is_bundle(place)
        }  # fmt: skip
        hear("reading runs")
        found = collect([bundles[place].folder if place in bundles else place for place in places])
        records = found.rows.to_pylist(maps_as_pydicts="strict") if bundles or everything else []
        roots = [(str(bundles[p].folder if p in bundles else p), p, bundles.get(p)) for p in places]
        origins = [_origin(folder, roots) for folder in found.folders]
        certified = found.rows["certified"].to_pylist()
        anew: list[Anew | None] = []
        for number, (folder, (_, bundle)) in enumerate(zip(found.folders, origins, strict=True)):
            asked = (everything or bundle is not None) and not trust
            if asked:
                hear(f"judging plan {number + 1} of {len(origins)} again")
            anew.append(recertify(folder, not certified[number]) if asked else None)
        rows = found.rows
        if records:
            rows = table_of(_corrected(record, one) for record, one in zip(records, anew, strict=True))
        where = rows.select(["cpu", "cpu_count"]).to_pylist()
        yield Gathered(
            rows, found.folders, _told(found.problems, bundles),
            tuple(b.manifest.machine if b else machine_name(w) for w, (_, b) in zip(where, origins, strict=True)),
            tuple(_whose(one, bundle) for one, (_, bundle) in zip(anew, origins, strict=True)),
            tuple(anew), tuple(str(place or "") for place, _ in origins),
        )  # fmt: skip


def _told(problems: dict[Path, str], bundles: dict[Path, Bundle]) -> dict[Path, str]:
    """Files of bundles by where they are in the bundle, not where it was unpacked."""
    told = {}
    for path, problem in problems.items():
        inside = (b / path.relative_to(o.folder) for b, o in bundles.items() if path.is_relative_to(o.folder))
        told[next(inside, path)] = problem
    return told


def _origin(
    folder: Path | None, roots: Sequence[tuple[str, Path, Bundle | None]]
) -> tuple[Path | None, Bundle | None]:
    """The place that was given in which a run was found; there may be ten thousands of runs."""
    text = str(folder)
    for root, place, bundle in roots if folder is not None else ():
        if text == root or text.startswith(f"{root}{os.sep}") or root == ".":
            return place, bundle
    return None, None


def _whose(anew: Anew | None, bundle: Bundle | None) -> str:
    if anew is None:
        return RECORDED if bundle else "own record"
    return anew.said if anew.certified is not None else f"{RECORDED}; {anew.said}"


def _corrected(record: Record, anew: Anew | None) -> dict[str, Any]:
    """A record where a plan that is refused here is not certified, whatever is written there; a refusal there stays one."""
    if anew is None or anew.certified is None:
        return record
    if not record["certified"]:
        return record
    corrected = {**record, "travel_time_s": anew.travel_time}
    if anew.objective is not None:
        corrected["objective"] = anew.objective
    if anew.certified:
        return corrected
    return {
        **corrected, "certified": False, "status": Status.UNCERTIFIED, "reasons": [*anew.reasons], "gap_percent": None,
    }  # fmt: skip
