"""`benchbench best DIR ...`: keep certified plans as best known."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from benchbench.cli.arguments import Parser
from benchbench.ground.errors import BadInput
from benchbench.run.telling import complain

if TYPE_CHECKING:
    from benchbench.storage.best_known import KnownValue
    from benchbench.storage.schema import Record

EPILOG = """Only certified plans count, and only those better by more than 1e-6 of the travel time; of an MPCC that comes ready-made its
objective. A plan whose command line does not give its task again (another default, own YAML without --config-dir) is left out and
named; so is one of a class that is not installed.

examples
  benchbench best results/runs/2026-01-01/12-00-00-000000
  benchbench best results --file mine.yaml
  benchbench best results --config-dir examples/block_and_wall/conf

Runs look up the file that comes with BenchBench, references/best_known.yaml and best_known.yaml in their folder of
results (`output`).
"""


def run(arguments: Sequence[str]) -> int:
    """Merge and print what changed; raises BadInput."""
    from benchbench.storage.best_known import BestKnown

    asked = parser().parse_args(arguments)
    entries = dict(BestKnown.load(asked.file).entries)
    changed = 0
    for record, folder in _runs(asked.folders):
        new = _better(record, folder, entries, asked.config_dir)
        if new is not None:
            print(_told(new, entries.get(new["task_hash"])))
            entries[new["task_hash"]] = new
            changed += 1
    if changed:
        BestKnown(entries).save(asked.file)
    print(f"{changed or 'nothing'} changed; {len(entries)} values in {asked.file}")
    return 0


def _better(
    record: Record, folder: Path, entries: dict[str, KnownValue], own: Path | None
) -> KnownValue | None:
    """What a certified record adds to the entries, None where it adds nothing."""
    from benchbench.storage.best_known import beats, cost, entry, value

    old, found = entries.get(record["task_hash"]), cost(record)
    if found is None or not beats(found, None if old is None else value(old)):
        return None
    try:
        return entry(record, _command(record, folder, own))
    except BadInput as error:
        complain("left out", str(error))
        return None


def _runs(folders: Sequence[Path]) -> Iterator[tuple[Record, Path]]:
    """Certified records with a task, and their folders; raises BadInput for a folder without any record."""
    from benchbench.storage.collect import collect

    found = collect(folders)
    for path, problem in found.problems.items():
        complain("left out", f"{path}: {problem}")
    runs = [
        (r, f)
        for r, f in zip(found.rows.to_pylist(maps_as_pydicts="strict"), found.folders, strict=True)
        if f is not None
    ]
    for folder in folders:
        if not any(place.resolve().is_relative_to(folder.resolve()) for _, place in runs):
            raise BadInput(str(folder), "has no record of a run", "a run's folder, or folders with some")
    yield from ((r, f) for r, f in runs if r["certified"] and r["task_hash"])


def _command(record: Record, folder: Path, own: Path | None) -> str:
    """Overrides that give the record's task again, with the folder of own configuration in front; raises BadInput where they do not."""
    from benchbench.run import config
    from benchbench.run.overrides import quoted
    from benchbench.run.settings import NOT_DECISIVE
    from benchbench.storage.configuration import read

    file = folder / ".hydra" / "overrides.yaml"
    if not file.is_file():
        raise BadInput(str(folder), "has no .hydra/overrides.yaml, so nobody knows how it was made")
    try:
        said = read(file)
    except ValueError as error:
        raise BadInput(str(file), str(error)) from None
    told = [
        text
        for text in map(str, said if isinstance(said, list) else ())
        if text.split("=")[0].lstrip("+~") not in NOT_DECISIVE
    ]
    for text in told:
        if "${" in text or text.lstrip("+~").startswith("hydra"):
            raise BadInput(
                str(folder), f"its override '{text}' is no plain value, so it is not composed again"
            )
    search = [f"hydra.searchpath=[{quoted(f'file://{own.absolute()}')}]"] if own else []
    if config.compose_any(*told, *search, stored=True).task_hash != record["task_hash"]:
        raise BadInput(str(folder), f"'{shlex.join(told)}' is another task than the one of this run")
    return shlex.join([*(("--config-dir", str(own)) if own else ()), *told])


def _told(new: KnownValue, old: KnownValue | None) -> str:
    from benchbench.storage.best_known import gap, value

    if "objective" in new:
        what, unit = f"{new['scenario']}, {new['command']}: {new['objective']:.8g}", ""
    else:
        kappa = f", kappa_init = {new['kappa_init']}" if "kappa_init" in new else ""
        what = f"{new['scenario']}, {new['dynamics']}, N = {new['intervals']}{kappa}: {new['travel_time_s']:.6f} s"
        unit = " s"
    if old is None:
        return f"{what}, the first"
    was = f"{value(old):.6f} s" if unit else f"{value(old):.8g}"
    return f"{what}, was {was} ({gap(value(new), value(old)):+.4f} %)"


def parser() -> Parser:
    """Return the arguments it takes."""
    takes = Parser("best", "Merge certified plans into the file of best known values.", EPILOG)
    takes.add_argument(
        "folders", nargs="+", type=Path, metavar="DIR", help="a run's folder, or folders with runs"
    )
    default = Path("references", "best_known.yaml")
    takes.add_argument("--file", type=Path, default=default, help=f"what is updated (default: {default})")
    takes.add_argument(
        "--config-dir",
        type=Path,
        metavar="DIR",
        help="the folder of your own configuration that the runs were made with",
    )
    return takes
