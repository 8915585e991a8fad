"""The program: `python -m benchbench +scenario=circle solver=ipopt`; exit code 0 certified, 1 not, 2 bad input."""

from __future__ import annotations

import hashlib
import os
import sys
from importlib.metadata import entry_points
from pathlib import Path

import hydra
from hydra.core.config_search_path import ConfigSearchPath
from hydra.core.hydra_config import HydraConfig
from hydra.core.plugins import Plugins
from hydra.errors import HydraException
from hydra.plugins.search_path_plugin import SearchPathPlugin
from hydra.types import RunMode
from omegaconf import DictConfig, OmegaConf
from omegaconf.errors import OmegaConfBaseException
from rich.console import Console

from benchbench import config, pipeline, summary
from benchbench.errors import BadInput, BenchBenchError
from benchbench.progress import LiveLine

USAGE = """benchbench plans a flight, certifies the plan, stores it and shows it.

  python -m benchbench +scenario=NAME [FIELD=VALUE ...]     one run
  python -m benchbench -m +scenario=A,B FIELD=V1,V2 ...     all combinations

Scenarios: {scenarios}
Every field can be overridden, for example scenario.kappa_init=5 scenario.intervals=150 dynamics.inputs=averaged.
See all of them with --cfg job; use your own YAML folder with --config-dir FOLDER; --traceback shows tracebacks.
"""


class ThirdPartyConfig(SearchPathPlugin):
    """Adds the config packages that installed packages name in the entry point group `benchbench.conf`."""

    def manipulate_search_path(self, search_path: ConfigSearchPath) -> None:
        """Append pkg://<package> for each of them."""
        for entry in entry_points(group="benchbench.conf"):
            search_path.append(provider=f"benchbench:{entry.name}", path=f"pkg://{entry.value}")


def main() -> None:
    """Entry point of the console script and of `python -m benchbench`; never returns, exits with a code."""
    traceback = "--traceback" in sys.argv
    sys.argv = [a for a in sys.argv if a != "--traceback"]
    if len(sys.argv) == 1:
        print(USAGE.format(scenarios=", ".join(config.scenarios())))
        raise SystemExit(2)
    os.environ["HYDRA_FULL_ERROR"] = "1"  # errors reach us, we say them in one message
    codes: list[int] = []
    try:
        _application(codes)
    except (BenchBenchError, HydraException, OmegaConfBaseException, OSError) as error:
        if traceback:
            raise
        _complain(error)
        raise SystemExit(2) from None
    raise SystemExit(max(codes, default=0))


def _application(codes: list[int]) -> None:
    Plugins.instance().register(ThirdPartyConfig)

    def task(cfg: DictConfig) -> None:
        multirun = HydraConfig.get().mode == RunMode.MULTIRUN
        try:
            codes.append(_run(cfg))
        except BenchBenchError as error:
            if not multirun:
                raise
            _complain(error)  # one bad combination does not stop the others
            codes.append(2)

    hydra.main(version_base="1.3", config_path=config.folder(), config_name="config")(task)()


def _run(cfg: DictConfig) -> int:
    hydra_cfg = HydraConfig.get()
    folder = Path(hydra_cfg.runtime.output_dir)
    text = OmegaConf.to_yaml(cfg, resolve=True)
    root = Path(hydra_cfg.runtime.cwd) / cfg.output
    labels = {"run_id": _run_id(folder, root), "config_hash": config_hash(cfg)}
    case = config.build(cfg, dict(hydra_cfg.runtime.choices))
    with LiveLine() as line:
        done = pipeline.run(case, line, labels)
        paths = pipeline.write(done, folder, root, text)
    summary.show(done.record, paths)
    return 0 if done.certificate.certified else 1


def config_hash(cfg: DictConfig) -> str:
    """Hash of everything that decides the result of a run: the composed config without the output folder."""
    decisive = {str(k): v for k, v in OmegaConf.to_container(cfg, resolve=True).items() if k != "output"}  # type: ignore[union-attr]
    return hashlib.sha256(OmegaConf.to_yaml(OmegaConf.create(decisive), sort_keys=True).encode()).hexdigest()[
        :16
    ]


def _run_id(folder: Path, root: Path) -> str:
    inside = folder.resolve().is_relative_to(root.resolve())
    return "_".join(
        (folder.resolve().relative_to(root.resolve()) if inside else folder.resolve()).parts[-4:]
    ).replace("/", "")


def _complain(error: Exception) -> None:
    console = Console(stderr=True, highlight=False)
    if isinstance(error, OSError) and not isinstance(error, BenchBenchError):
        error = BadInput(
            "output",
            f"cannot write: {error.strerror or error} ({error.filename})",
            "a folder you may write to",
        )
    text = str(error).replace(
        "Set the environment variable HYDRA_FULL_ERROR=1 for a complete stack trace.", ""
    )
    console.print("benchbench: [bold red]bad input[/bold red]", end="\n  ")
    console.print(text.strip(), markup=False, soft_wrap=True)
