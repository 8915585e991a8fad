"""Flights of a plan, as a configuration asks for them."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from omegaconf import DictConfig

from benchbench.flight.autopilot import Autopilot
from benchbench.flight.campaign import Campaign
from benchbench.flight.controller import Controller
from benchbench.flight.limits import FlightLimits
from benchbench.flight.mismatch import Mismatch
from benchbench.flight.payload import Payload
from benchbench.flight.predictor import Predictor
from benchbench.flight.residual import Residual
from benchbench.flight.rig import Rig
from benchbench.flight.world import World
from benchbench.ground.errors import BadInput
from benchbench.run.making import made
from benchbench.run.overrides import keys

COUNT, TARGET = "flights", "target_success"
MOST = 1_000_000
DEFAULTS = {
    # the engine that no planner has written, the paper's controller, and PX4's equations, which real vehicles run
    "world": "mujoco", "controller": "nmpc", "autopilot": "px4",
    # nothing is corrected, and all is known, unless asked for: what is added then is seen; a mass of 75 g is weighed before
    "residual": "none", "payload": "known", "predictor": "known",
    "mismatch": "lab", "rig": "light",
}  # fmt: skip
"""What flights choose where nothing else is said."""
JUDGE, JUDGING = "judge", "certificate@judge"
JUDGED = f"{JUDGING}=flight"
KINDS: dict[str, type] = {
    "world": World, "controller": Controller, "autopilot": Autopilot, "residual": Residual, "payload": Payload,
    "predictor": Predictor,    "mismatch": Mismatch, "rig": Rig, JUDGE: FlightLimits,
}  # fmt: skip
FIELDS = (COUNT, TARGET, *KINDS)


def flying(overrides: Sequence[str], chosen_before: Collection[str] = ()) -> list[str]:
    """Return what overrides that ask for flights imply: the choices that are not made; one flight where there is no number.

    chosen_before: what files of the user's own have chosen. Raises what Hydra does for what is no override.
    """
    asked = keys(overrides)
    about = {key.partition(".")[0] for key in asked} & {*FIELDS}
    if not about or (about == {COUNT} and f"{COUNT}=0" in overrides):
        return []
    chosen = {key for key in asked if "." not in key} | {*chosen_before}
    judged = JUDGE in chosen or any(text.lstrip("+").startswith(f"{JUDGING}=") for text in overrides)
    more = [f"{group}={name}" for group, name in DEFAULTS.items() if group not in chosen]
    return [*more, *([] if judged else [JUDGED]), *([] if COUNT in chosen else [f"{COUNT}=1"])]


def campaign(cfg: DictConfig, chosen: Mapping[str, Any]) -> Campaign | None:
    """Make the campaign of a composed configuration; None where no flights are asked for. Raises BadInput."""
    count = cfg.get(COUNT, 0)
    if type(count) is not int or not 0 <= count <= MOST:
        raise BadInput(COUNT, f"{count!r} was given", f"a whole number of at least 0, at most {MOST}")
    if count == 0:
        return None
    for group in KINDS:
        if not isinstance(cfg.get(group), DictConfig):
            usual = DEFAULTS.get(group)
            raise BadInput(
                group, "none was chosen", f"{group}={usual}" if usual else f"{JUDGED}, for flights or none"
            )
    parts = {group: made(cfg, group, kind) for group, kind in KINDS.items()}
    names = {group: str(chosen.get(group) or "custom") for group in DEFAULTS}
    target = cfg.get(TARGET)
    if target is not None and (type(target) not in (int, float) or not 0 < target < 1):
        raise BadInput(TARGET, f"{target!r} was given", "a number above 0 and below 1, or null")
    return Campaign(count=count, seed=cfg.seed, limits=parts.pop(JUDGE), names=names, target=target, **parts)


def decisive(tree: Mapping[str, Any]) -> dict[str, Any]:
    """Return a configuration without what flights alone are about, where there are none: it is that of the plan."""
    return dict(tree) if tree.get(COUNT) else {k: v for k, v in tree.items() if k not in FIELDS}
