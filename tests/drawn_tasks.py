"""Writes `tests/drawn_tasks.yaml`: three tasks of each family, as they were drawn when the families were published.

A family keeps its tasks for good: where a range has to change, it is a new family, and this file gets new tasks, no other ones.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml
from omegaconf import OmegaConf

from benchbench.run import config

FAMILIES = ("random_handover", "random_hardware", "random_race", "random_delivery")
SEEDS = (0, 7, 100)
FILE = Path(__file__).with_suffix(".yaml")
HANDOVER = ("start", "end", "kappa_init", "contact_seconds", "intervals", "target")
FIELDS = {
    "random_handover": HANDOVER, "random_hardware": HANDOVER,
    "random_race": ("start", "end", "end_velocity", "track"),
    "random_delivery": ("start", "end", "stops", "order", "visit", "intervals"),
}  # fmt: skip


def task(family: str, seed: int) -> dict[str, Any]:
    """Return what the family draws, from a composed configuration."""
    cfg, _ = config.composed(f"+scenario={family}", f"seed={seed}")
    scenario: Any = OmegaConf.to_container(cfg.scenario)
    return {name: scenario[name] for name in FIELDS[family]}


if __name__ == "__main__":
    tasks = {f"{family}_{seed}": task(family, seed) for family in FAMILIES for seed in SEEDS}
    FILE.write_text(yaml.safe_dump(tasks, sort_keys=False, default_flow_style=None, width=130))
