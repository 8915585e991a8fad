"""What makes two travel times comparable: one hash of the task, the transcription and its grid; of an MPCC, of its content."""

from __future__ import annotations

import gzip
import hashlib
import inspect
import io
import json
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hydra.utils import get_object
from omegaconf import DictConfig, OmegaConf

from benchbench.ocp.kinds import fields_of, kind_of
from benchbench.ocp.sizes import JSON_BYTES

LABELS = ("name",)
FILES = (".csv", ".yaml", ".yml", ".json", ".json.gz")
"""Suffixes of files that hold a part of a task: a track, the motion of a target, an MPCC; by what they say, packed or not."""


def task_hash(cfg: DictConfig) -> str:
    """Return the hash of what is flown, under which limits it is certified, and on which transcription and grid.

    Read from scenario, vehicle, dynamics and certificate of a composed configuration. What has no part in it: names,
    guesses and margins of the planner, whether and how long stationarity is looked for, and how the problem is solved. A field at its
    class's default counts as left out, so that a new field with a default changes nothing. An MPCC that comes ready-made is its class
    with what that is given, files by what they say, and the limits.
    """
    tree: Any = OmegaConf.to_container(cfg, resolve=True)
    content = {
        **_asked(tree),
        **({} if _ready(tree["scenario"]) else {"dynamics": _content(tree["dynamics"])}),
        "certificate": _without(_content(tree["certificate"]), ("stationarity", "stationarity_seconds")),
    }
    return _hash(content)


def asked_hash(cfg: DictConfig) -> str:
    """Return the hash of what is asked alone, of scenario and vehicle: methods of all transcriptions may be compared on it."""
    return _hash(_asked(OmegaConf.to_container(cfg, resolve=True)))


def _ready(scenario: Any) -> bool:
    """Whether a scenario's configuration is that of an MPCC that comes ready-made: it names its class."""
    return "_target_" in scenario


def _asked(tree: Any) -> dict[str, Any]:
    if _ready(tree["scenario"]):
        return {"scenario": _without(_content(tree["scenario"]), LABELS)}
    scenario, kind = fields_of(tree["scenario"]), kind_of(tree["scenario"])
    return {
        "scenario": _without(_content(scenario, _defaults(kind)), (*kind.planning, *LABELS)),
        "vehicle": _without(_content(tree["vehicle"]), LABELS),
    }


def _hash(content: Any) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:16]


def _content(value: Any, defaults: Mapping[str, Any] | None = None) -> Any:
    """A part of the configuration with one way to write each thing."""
    if isinstance(value, Mapping):
        kind = get_object(value["_target_"]) if "_target_" in value else None
        usual = _defaults(kind) if kind else defaults or {}
        said = {k: _content(v) for k, v in value.items() if k != "_target_"}
        said = {k: v for k, v in said.items() if v not in (None, {}) and v != usual.get(k, _NOTHING)}
        return {"_target_": f"{kind.__module__}.{kind.__qualname__}", **said} if kind else said
    if isinstance(value, list | tuple):
        return [_content(one) for one in value]
    if isinstance(value, str | Path) and str(value).endswith(FILES) and Path(value).is_file():
        return hashlib.sha256(_said(Path(value))).hexdigest()
    return float(value) if isinstance(value, int) and not isinstance(value, bool) else value


def _said(file: Path) -> bytes:
    """What a file says, unpacked; one that is damaged or unpacks to too much stands for itself, and its reader tells."""
    packed = file.read_bytes()
    if file.suffix != ".gz":
        return packed
    try:
        with gzip.open(io.BytesIO(packed)) as stream:
            found = stream.read(JSON_BYTES + 1)
    except (OSError, EOFError, zlib.error):
        return packed
    return packed if len(found) > JSON_BYTES else found


_NOTHING = object()


def _defaults(kind: Any) -> dict[str, Any]:
    """Defaults of a class (or function) by the names it takes, plain ones only."""
    fields = inspect.signature(kind).parameters.values()
    plain = (bool, int, float, str, tuple)
    return {f.name: _content(f.default) for f in fields if isinstance(f.default, plain)}


def _without(content: dict[str, Any], names: tuple[str, ...]) -> dict[str, Any]:
    return {key: value for key, value in content.items() if key not in names}
