"""A bundle: the runs of a folder in one archive that others can open and need not trust.

A zip file with `bundle.json` (what is in it, each file with its length and SHA-256, where and with what it was made) and a folder
for each run: record, configuration, overrides, plan or solution, flights. Pictures are left out, they can be drawn again.
A bundle is opened only whole: every file is there, has its hash, and none is beside them.
"""

from __future__ import annotations

import hashlib
import json
import re
import tempfile
import zipfile
import zlib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path, PurePosixPath
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from benchbench.ground.errors import BadInput, invalid
from benchbench.storage import provenance
from benchbench.storage.collect import collect
from benchbench.storage.files import CONFIG, FLIGHTS, PLAN, RECORD, SOLUTION, replacing

FORMAT, VERSION, MANIFEST, SUFFIX = "benchbench-bundle", 1, "bundle.json", ".zip"
OVERRIDES = ".hydra/overrides.yaml"
BESIDE = (CONFIG, OVERRIDES, PLAN, SOLUTION, FLIGHTS)
"""Files of a run that go with its record."""
NAME = re.compile(rf"runs/\d{{5,9}}/({'|'.join(map(re.escape, (RECORD, *BESIDE)))})")
LARGEST_MANIFEST, GROWTH, SMALL = 200_000_000, 200, 50_000_000
"""Bytes of the list of files; how many times larger than the archive its files may be, and what is never too large."""
CHUNK = 1 << 20
ALLOWED = "a file that `benchbench bundle` wrote"
BROKEN = (OSError, EOFError, ValueError, NotImplementedError, RuntimeError, zipfile.BadZipFile, zlib.error)
"""What reading a damaged archive raises."""

Hear = Callable[[str], None]


class Entry(BaseModel):
    """A file of a bundle: its SHA-256 and its length in bytes."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    sha256: str = Field(pattern="[0-9a-f]{64}")
    bytes: int = Field(ge=0)


class Manifest(BaseModel):
    """What a bundle says of itself; `environment` are versions and machine, as the bundler's own program saw them."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    format: str
    version: int
    machine: str = Field(max_length=200)
    made_at: str
    runs: int
    environment: dict[str, Any]
    files: dict[str, Entry]


@dataclass(frozen=True)
class Bundle:
    """An opened bundle: a folder with its runs, which is gone when it is closed, and what it says of itself."""

    folder: Path
    manifest: Manifest


def is_bundle(path: Path) -> bool:
    """Whether a path is meant as one: a file, not a folder."""
    return path.is_file() or path.suffix == SUFFIX


def pack(folder: Path, output: Path, machine: str | None, hear: Hear) -> tuple[Manifest, dict[Path, str]]:
    """Write the runs below a folder as a bundle; return its manifest, and which files were of no use and why.

    machine: what to call it; by default its processor and how many may be used. Raises BadInput where there is no run, or
    the file cannot be written.
    """
    found = collect([folder])
    if not found.rows.num_rows:
        raise BadInput(str(folder), "no run was found", "a folder with results, as runs write them")
    here = provenance.collect()
    files: dict[str, Entry] = {}
    with replacing(output) as temporary, zipfile.ZipFile(temporary, "x", zipfile.ZIP_DEFLATED) as archive:
        for number, place in enumerate(found.folders):
            hear(f"packing run {number + 1} of {len(found.folders)}")
            record = (found.rows.slice(number, 1).to_pylist(maps_as_pydicts="strict")[0], place)
            for name, data in _contents(*record):
                inside = f"runs/{number:05}/{name}"
                archive.writestr(zipfile.ZipInfo(inside), data, zipfile.ZIP_DEFLATED)
                files[inside] = Entry(sha256=hashlib.sha256(data).hexdigest(), bytes=len(data))
        manifest = Manifest(
            format=FORMAT, version=VERSION, machine=machine or machine_name(here), runs=len(found.folders), files=files,
            made_at=datetime.now(UTC).isoformat(timespec="seconds"), environment={**here, "packages": _packages()},
        )  # fmt: skip
        text = json.dumps(manifest.model_dump(), indent=1)
        archive.writestr(zipfile.ZipInfo(MANIFEST), text, zipfile.ZIP_DEFLATED)
    return manifest, found.problems


def machine_name(where: Mapping[str, Any]) -> str:
    """What a machine is called that has no name: its processor, and how many of them may be used."""
    count = where.get("cpu_count")
    return f"{where.get('cpu') or 'unknown'}" + (f", {count} CPUs" if count else "")


@contextmanager
def opened(path: Path, hear: Hear) -> Iterator[Bundle]:
    """Verify a bundle and unpack it into a folder of its own until the context ends.

    Raises BadInput for what is no bundle, is cut off, was changed, or holds a file that is no part of one.
    """
    with tempfile.TemporaryDirectory(prefix="benchbench_bundle_") as scratch:
        yield Bundle(Path(scratch), _unpacked(path, Path(scratch), hear))


def _contents(record: Mapping[str, Any], place: Path | None) -> Iterator[tuple[str, bytes]]:
    """The files of a run by their name in the bundle."""
    yield RECORD, (json.dumps(record, indent=2, ensure_ascii=False) + "\n").encode()
    for name in BESIDE if place is not None else ():
        if (file := Path(place or "", name)).is_file():
            yield name, file.read_bytes()


def _packages() -> dict[str, str]:
    """Versions of everything that is installed."""
    found = {str(one.name): str(one.version) for one in metadata.distributions()}
    return dict(sorted(found.items(), key=lambda item: item[0].lower()))


def _unpacked(path: Path, scratch: Path, hear: Hear) -> Manifest:
    if not path.is_file():
        raise BadInput(str(path), "there is no such file", ALLOWED)
    try:
        with zipfile.ZipFile(path) as archive:
            manifest = _manifest(path, archive)
            _check_names(path, archive, manifest)
            for number, (name, entry) in enumerate(manifest.files.items()):
                hear(f"verifying {path.name}, file {number + 1} of {len(manifest.files)}")
                _extract(path, archive, name, entry, scratch)
    except BROKEN as error:
        said = " ".join(str(error).split()) or type(error).__name__
        raise BadInput(str(path), f"is no bundle, or cut off or damaged: {said}", ALLOWED) from None
    return manifest


def _manifest(path: Path, archive: zipfile.ZipFile) -> Manifest:
    inside = {info.filename: info for info in archive.infolist()}
    if MANIFEST not in inside:
        raise BadInput(str(path), f"is an archive, but has no {MANIFEST}", ALLOWED)
    if inside[MANIFEST].file_size > LARGEST_MANIFEST:
        raise BadInput(str(path), f"its {MANIFEST} is larger than {LARGEST_MANIFEST / 1e6:g} MB", ALLOWED)
    try:
        values = json.loads(archive.read(MANIFEST))
        manifest = Manifest.model_validate(values)
    except ValidationError as error:
        raise invalid(f"{path}: {MANIFEST}", error, Manifest.model_fields) from None
    except RecursionError:
        raise BadInput(str(path), f"its {MANIFEST} is nested too deeply", ALLOWED) from None
    if manifest.format != FORMAT or manifest.version > VERSION:
        problem = f"is of format '{manifest.format}', version {manifest.version}"
        raise BadInput(str(path), problem, f"{FORMAT}, version {VERSION} or earlier")
    return manifest


def _check_names(path: Path, archive: zipfile.ZipFile, manifest: Manifest) -> None:
    """Raise BadInput unless the archive holds the files of its list, each once, and they are files of runs and not too large."""
    infos = archive.infolist()
    for name in [*(info.filename for info in infos), *manifest.files]:
        if _leaves(name):
            raise BadInput(str(path), f"holds '{name}', which leaves its folder", ALLOWED)
        if name != MANIFEST and not NAME.fullmatch(name):
            raise BadInput(str(path), f"holds '{name}', which is no file of a run", ALLOWED)
    names = [info.filename for info in infos if info.filename != MANIFEST]
    if lost := manifest.files.keys() - {*names}:
        raise BadInput(str(path), f"'{min(lost)}' is missing", ALLOWED)
    if more := [name for name in names if name not in manifest.files or names.count(name) > 1][:1]:
        raise BadInput(str(path), f"holds '{more[0]}', which is not in its list, or twice", ALLOWED)
    whole = sum(entry.bytes for entry in manifest.files.values())
    if whole > max(SMALL, GROWTH * path.stat().st_size):
        raise BadInput(str(path), f"would fill {whole / 1e6:.0f} MB, {GROWTH} times its own size", ALLOWED)


def _leaves(name: str) -> bool:
    """Whether a path would lead out of the folder it is put into, on any system."""
    return "\\" in name or ":" in name or name.startswith("/") or ".." in PurePosixPath(name).parts


def _extract(path: Path, archive: zipfile.ZipFile, name: str, entry: Entry, scratch: Path) -> None:
    """Unpack one file, never more of it than is said; raises BadInput where it is another one."""
    target, digest, left = scratch / name, hashlib.sha256(), entry.bytes
    target.parent.mkdir(parents=True, exist_ok=True)
    with archive.open(name) as source, target.open("wb") as file:
        while left >= 0 and (data := source.read(min(left + 1, CHUNK))):
            left -= len(data)
            digest.update(data)
            file.write(data)
    if left or digest.hexdigest() != entry.sha256:
        raise BadInput(str(path), f"'{name}' is not what was bundled: its SHA-256 is another", ALLOWED)
