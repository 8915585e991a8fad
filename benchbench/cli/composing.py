"""Hydra's way from the command line to our runs, but for a composition that its own way makes and throws away."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Callable
from pathlib import Path

import hydra
from hydra import version
from hydra._internal.hydra import Hydra
from hydra._internal.utils import create_config_search_path
from hydra.core.config_search_path import ConfigSearchPath, SearchPathQuery
from hydra.core.global_hydra import GlobalHydra
from hydra.errors import SearchPathException
from omegaconf import DictConfig

from benchbench.run import config

NAME = "config"
OTHERWISE = (
    "help",
    "hydra_help",
    "cfg",
    "info",
    "shell_completion",
    "experimental_rerun",
    "config_name",
    "config_path",
)
"""Options with which something else is asked than to run our configuration."""


def compose_and_run(options: Namespace, task: Callable[[DictConfig], None]) -> None:
    """Compose the configuration, or all of a sweep, and call the task with it; raises what Hydra does.

    `hydra.main` composes it once more beforehand, a tenth of a second, to see whether it sets `hydra.mode`: it has its way
    where that, or more than a run, is asked for.
    """
    more = any(getattr(options, name) for name in OTHERWISE) or (options.run and options.multirun)
    if more or any("hydra.mode" in one for one in options.overrides):
        hydra.main(version_base="1.3", config_path=config.folder(), config_name=NAME)(task)()
        return
    version.setbase("1.3")
    ours = Hydra.create_main_hydra2("benchbench", _search_path(options.config_dir))
    mode, go = ("MULTIRUN", ours.multirun) if options.multirun else ("RUN", ours.run)
    try:
        go(config_name=NAME, task_function=task, overrides=[*options.overrides, f"hydra.mode={mode}"])
    finally:
        GlobalHydra.instance().clear()


def _search_path(more: str | None) -> ConfigSearchPath:
    path = create_config_search_path(config.folder())
    if more is not None:
        folder = Path(more).absolute()
        if not folder.is_dir():
            raise SearchPathException(f"Additional config directory '{folder}' not found")
        path.prepend("command-line", f"file://{folder}", SearchPathQuery(provider="schema"))
    return path
