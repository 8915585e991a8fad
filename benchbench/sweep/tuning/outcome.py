"""What a study found: its trials as CSV, its Pareto front as table and picture, its best as a configuration."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import optuna
from hydra.core.override_parser.overrides_parser import OverridesParser
from matplotlib.figure import Figure
from omegaconf import OmegaConf
from optuna.trial import FrozenTrial, TrialState

from benchbench.run import config, flying
from benchbench.storage.files import write_bytes

BEST = "tuned/best.yaml"


def good(study: optuna.Study) -> list[FrozenTrial]:
    """Trials whose plans are all certified."""
    return [
        t for t in study.get_trials(states=(TrialState.COMPLETE,)) if not t.user_attrs.get("uncertified", 1)
    ]


def front(study: optuna.Study) -> list[FrozenTrial]:
    """The good trials that no other good one beats in all objectives, best in the first one first."""
    found = good(study)
    kept = [t for t in found if not any(_dominates(_rounded(other), _rounded(t)) for other in found)]
    return sorted(kept, key=_rounded)


def write(
    study: optuna.Study,
    objectives: Sequence[str],
    folder: Path,
    fixed: Sequence[str],
    problem: Sequence[str] = (),
) -> dict[str, Path]:
    """Write trials.csv, front.csv, front.png and the best configuration; returns the paths.

    fixed: overrides of every run; problem: those of one of the problems.
    """
    folder.mkdir(parents=True, exist_ok=True)
    best = front(study)
    paths = {"trials": folder / "trials.csv", "front": folder / "front.csv"}
    write_bytes(paths["trials"], study.trials_dataframe().to_csv(index=False).encode())
    heads = [*objectives, "trial", *(best[0].params if best else ())]
    lines = [",".join(_quoted(x) for x in (*t.values, t.number, *t.params.values())) for t in best]
    write_bytes(paths["front"], "\n".join([",".join(heads), *lines, ""]).encode())
    if best:
        paths["picture"] = folder / "front.png"
        _draw(study, best, objectives, paths["picture"])
        paths["best"] = folder / BEST
        paths["best"].parent.mkdir(exist_ok=True)
        write_bytes(paths["best"], as_config(best[0].params, fixed, study.study_name, problem).encode())
    return paths


def as_config(params: Mapping[str, Any], fixed: Sequence[str], name: str, problem: Sequence[str] = ()) -> str:
    """YAML that the main command takes with `--config-dir FOLDER +scenario=NAME +tuned=best`.

    It holds what the overrides imply on the command line, too: in a file nothing is implied.
    """
    texts = [*fixed, *(f"{field}={value}" for field, value in params.items())]
    texts = config.meant([*problem, *texts])[len(problem) :]
    fields: dict[str, Any] = {}
    groups = []
    for parsed in OverridesParser.create().parse_overrides(texts):
        if parsed.key_or_group in {*config.KINDS, *flying.DEFAULTS} - {"scenario"}:
            groups.append({f"override /{parsed.get_key_element().lstrip('+')}": parsed.value()})
        elif "/" in parsed.key_or_group and not parsed.key_or_group.startswith("hydra"):
            groups.append({f"/{parsed.get_key_element().lstrip('+')}": parsed.value()})
        elif not parsed.key_or_group.startswith("hydra") and parsed.key_or_group != "scenario":
            fields[parsed.key_or_group] = parsed.value()
    content = OmegaConf.create({"defaults": [*groups, "_self_"]})
    for field, value in fields.items():
        OmegaConf.update(content, field, value, force_add=True)
    return (
        f"# @package _global_\n# The best of the study '{name}'; use: --config-dir FOLDER +scenario=NAME +tuned=best\n"
        + OmegaConf.to_yaml(content)
    )


def _dominates(one: Sequence[float], other: Sequence[float]) -> bool:
    return all(a <= b for a, b in zip(one, other, strict=True)) and one != other


def _rounded(trial: FrozenTrial) -> list[float]:
    """Objectives to six digits: what differs by less is the same."""
    return [float(f"{value:.6g}") for value in trial.values]


def _quoted(value: Any) -> str:
    text = str(value)
    return f'"{text}"' if "," in text else text


def _draw(study: optuna.Study, best: Sequence[FrozenTrial], objectives: Sequence[str], path: Path) -> None:
    mpl.use("agg")
    found = good(study)
    figure = Figure(figsize=(7.0, 4.5), layout="constrained")
    axes = figure.add_subplot()
    two = len(objectives) > 1

    def place(trials: Sequence[FrozenTrial]) -> tuple[list[float], list[float]]:
        first = [t.values[0] for t in trials]
        return (first, [t.values[1] for t in trials]) if two else ([float(t.number) for t in trials], first)

    axes.scatter(*place(found), color="0.6", label="certified")
    axes.plot(*place(best), "o-", color="#00734c", label="Pareto front" if two else "best")
    axes.set_xlabel(objectives[0] if two else "trial")
    axes.set_ylabel(objectives[1] if two else objectives[0])
    axes.set_title(f"{study.study_name}: {len(found)} of {len(study.trials)} trials certified")
    axes.legend()
    figure.savefig(path, dpi=150)
