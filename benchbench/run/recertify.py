"""A stored plan or solution judged again here, whoever made it and whatever its record says: by our limits and the task it says it is for."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import hydra
from omegaconf import OmegaConf
from pydantic import ValidationError

from benchbench.certificate.certify import certify, certify_problem
from benchbench.certificate.limits import Limits, ProblemLimits
from benchbench.ground.errors import BadInput, BenchBenchError
from benchbench.mpcc.residuals import residuals
from benchbench.ocp.reading import plain_yaml
from benchbench.planning.task_hash import asked_hash
from benchbench.run import judged, trust
from benchbench.run.choices import choices
from benchbench.run.config import folder as conf
from benchbench.run.failure import reason
from benchbench.run.stored import SCENE, problem_of, scene_parts
from benchbench.storage.configuration import configuration
from benchbench.storage.files import PLAN, SOLUTION, read_solution
from benchbench.storage.playback import read_mcap

NO_PART = ("_target_", "stationarity", "stationarity_seconds")
"""Fields of limits that certify nothing."""

REFUSED = "refused where it was made"
"""What is said of a plan that is not flown again."""


@dataclass(frozen=True)
class Anew:
    """What came out; without a certificate of ours `certified` is None and `said` why there is none.

    said    in words, also which of its own limits were not used
    asked   hash of scenario and vehicle, of what is flown or solved
    travel_time, objective  of the plan, or of the solution of an MPCC that is no flight, evaluated here
    """

    certified: bool | None
    said: str
    reasons: tuple[str, ...] = ()
    travel_time: float | None = None
    asked: str = ""
    objective: float | None = None


def recertify(folder: Path | None, refused: bool = False) -> Anew:
    """Judge the plan or solution in a run's folder; raises nothing for whatever lies there.

    refused: where it was made, which is believed, so that it is not judged again.
    """
    if folder is None or not any((folder / name).is_file() for name in (PLAN, SOLUTION)):
        return Anew(None, "there is no plan to certify")
    try:
        tree = configuration(folder)
        if tree is None:
            return Anew(None, "its configuration is missing, so nobody knows what was asked")
        if refused:
            return Anew(False, REFUSED, asked=_asked(tree))
        return _judged(folder, tree)
    except (BenchBenchError, OSError, ValueError) as error:
        return Anew(None, f"it cannot be certified here: {reason(error)}")
    except Exception as error:  # noqa: BLE001  # of another version, or of somebody who means ill
        return Anew(None, f"it cannot be certified here: {reason(error)}")


L = TypeVar("L", bound=ProblemLimits)


def ours(tree: Any, kind: type[L]) -> tuple[str, L, tuple[str, ...]]:
    """Return the limits that come with BenchBench and are nearest to some of a stored configuration, by name, and what differs.

    They replace them: a plan is not judged by limits that come with it. kind: of limits. Raises BadInput where there are none.
    """
    shipped = {name: limits for name, limits in _shipped().items() if type(limits) is kind}
    if not isinstance(tree, Mapping):
        raise BadInput("certificate", "is missing", ", ".join(shipped))
    given = {str(name): value for name, value in tree.items()}
    with suppress(BenchBenchError, ValidationError):  # what is left out there has a default
        trust.check(given, "certificate")
        given = kind(**{name: value for name, value in given.items() if name != "_target_"}).model_dump()
    differing = {name: _differing(given, limits.model_dump()) for name, limits in shipped.items()}
    nearest = min(differing, key=lambda name: len(differing[name]))
    return nearest, shipped[nearest], differing[nearest]


def _differing(one: Mapping[str, Any], other: Mapping[str, Any]) -> tuple[str, ...]:
    return tuple(sorted(key for key in {*one, *other} - {*NO_PART} if one.get(key) != other.get(key)))


def _judged(folder: Path, tree: Mapping[str, Any]) -> Anew:
    """What was found here before of the same plan, task and limits, else what is found now."""
    file, kind = (PLAN, Limits) if (folder / PLAN).is_file() else (SOLUTION, ProblemLimits)
    asked, certificate = _asked(tree), tree.get("certificate")
    name, limits, differing = ours(certificate, kind)
    told = "\n".join((file, hashlib.sha256((folder / file).read_bytes()).hexdigest(), asked, repr(limits)))
    key = hashlib.sha256(told.encode()).hexdigest()
    found = judged.recall(key)
    if found is None:
        found = _flown(folder, tree, limits) if isinstance(limits, Limits) else _solved(folder, tree, limits)
        judged.keep(key, found)
    instead = f", instead of its own {', '.join(differing)}" if differing else ""
    said = f"{'certified' if found['certified'] else 'refused'} anew by the limits of '{name}'{instead}"
    return Anew(
        found["certified"],
        said,
        tuple(found["reasons"]),
        found.get("travel_time"),
        asked,
        found.get("objective"),
    )


def _flown(folder: Path, tree: Mapping[str, Any], limits: Limits) -> dict[str, Any]:
    scenario, model = scene_parts(tree)
    plan = read_mcap(folder / PLAN).plan
    found = certify(plan, scenario, model, limits)
    return {
        "certified": found.certified,
        "reasons": [*found.reasons],
        "travel_time": plan.travel_time,
    }


def _solved(folder: Path, tree: Mapping[str, Any], limits: ProblemLimits) -> dict[str, Any]:
    """By the residuals of the problem that its configuration names; what it costs is evaluated here, too."""
    mpcc = problem_of(tree).mpcc()
    found = residuals(mpcc, mpcc.stacked(read_solution(folder)))
    verdict = certify_problem(found, limits)
    return {"certified": verdict.certified, "reasons": [*verdict.reasons], "objective": found.cost}


def _asked(tree: Mapping[str, Any]) -> str:
    """Hash of scenario and vehicle; raises BadInput where they are not made of installed plugins."""
    parts = {family: tree.get(family) for family in ("scenario", "vehicle")}
    for family, part in parts.items():
        trust.check(part, family, SCENE)
    return asked_hash(OmegaConf.create(parts))


@cache
def _shipped() -> dict[str, ProblemLimits]:
    """Our limits by name."""
    found = {}
    with hydra.initialize_config_dir(conf(), version_base="1.3"):
        for name in choices("certificate"):
            tree = plain_yaml(OmegaConf.to_yaml(hydra.compose(f"certificate/{name}").certificate))
            made = hydra.utils.instantiate(tree, _convert_="all")
            if isinstance(made, ProblemLimits):
                found[name] = made
    return found
