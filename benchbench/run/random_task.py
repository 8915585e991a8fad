"""A family of tasks in a configuration becomes the one task that the run's seed draws, as if somebody had typed it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from omegaconf import DictConfig, OmegaConf, open_dict, read_write

from benchbench.ground.errors import BadInput
from benchbench.ocp.task_family import Draws, TaskFamily
from benchbench.run.making import made

FAMILY = "family"
"""Field of a scenario with the ranges, and `seed`: of the task, null for the run's."""
DRAWN = "drawn"
"""Value of a field that is drawn."""
PLACE = f"scenario.{FAMILY}"
LARGEST = 2**63 - 1


def drawn(cfg: DictConfig) -> DictConfig:
    """Return the configuration with the task that its seed draws in place of the family; one without a family as it is.

    Drawn is what says so (`kappa_init: drawn`) and what is not there; what the YAML or the command line says stays. All that follows (certificate,
    hashes, records, a stored plan that is judged again) sees an ordinary scenario, whose name ends with the seed.

    A run's seed that drew the task does not disturb the start as well: it is 0 from here on, the guess as it is. With a seed of
    the task's own (`scenario.family.seed=7 seed=3`) the run's keeps its meaning. Raises BadInput.
    """
    scenario = cfg.get("scenario")
    if not isinstance(scenario, DictConfig) or not isinstance(scenario.get(FAMILY), DictConfig):
        return cfg
    cfg = cfg.copy()
    with read_write(cfg), open_dict(cfg):
        own = cfg.scenario[FAMILY].pop("seed", None)
        seed = _checked("seed", cfg.get("seed")) if own is None else _checked(f"{PLACE}.seed", own)
        family = made(cfg, PLACE, TaskFamily)
        name = str(cfg.scenario.get("name", "random"))
        fields = family.draw(Draws(name, seed))
        del cfg.scenario[FAMILY]
        _fill(cfg.scenario, fields)
        for place in _left(OmegaConf.to_container(cfg.scenario), "scenario"):
            raise BadInput(place, f"is to be {DRAWN}, but this family does not draw it", "a value of its own")
        cfg.scenario.name = f"{name}_{seed}"
        cfg.seed = 0 if own is None else cfg.seed
    return cfg


def _fill(node: DictConfig, fields: Mapping[str, Any]) -> None:
    """Put fields where it says so, and where nothing is; a part with a class was given as a whole."""
    for key, value in fields.items():
        there = node.get(key, DRAWN)
        if there == DRAWN:
            node[key] = value
        elif isinstance(there, DictConfig) and isinstance(value, Mapping) and "_target_" not in there:
            _fill(there, value)


def _left(tree: Any, place: str) -> Iterator[str]:
    """Places where it says `drawn` though nothing was."""
    if isinstance(tree, Mapping):
        for key, value in tree.items():
            yield from _left(value, f"{place}.{key}")
    elif tree == DRAWN:
        yield place


def _checked(field: str, seed: Any) -> int:
    if type(seed) is not int or not 0 <= seed <= LARGEST:
        raise BadInput(field, f"{seed!r} was given", f"a whole number of at least 0, at most {LARGEST:g}")
    return seed
