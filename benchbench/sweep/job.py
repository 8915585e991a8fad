"""One combination of a sweep, ready to be sent to a worker."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from hydra.core.hydra_config import HydraConfig
from hydra.types import RunMode
from omegaconf import DictConfig, open_dict, read_write

from benchbench.run.execution import Place
from benchbench.run.settings import Settings


@dataclass(frozen=True)
class Job:
    """A composed configuration with Hydra's own part; `number` counts from 1."""

    number: int
    config: DictConfig

    @classmethod
    def single(cls, case: DictConfig) -> Job:
        """Return the one run of this call; its folder is the one that Hydra has made."""
        config = case.copy()
        with read_write(config), open_dict(config):
            config.hydra = HydraConfig.get()
            with read_write(config.hydra):
                config.hydra.run.dir = config.hydra.runtime.output_dir
        return cls(1, config)

    @property
    def swept(self) -> bool:
        """One of several combinations."""
        return bool(self.config.hydra.mode == RunMode.MULTIRUN)

    @property
    def case(self) -> DictConfig:
        """The configuration without Hydra's part."""
        case = self.config.copy()
        with read_write(case), open_dict(case):
            del case["hydra"]
        return case

    @property
    def subdir(self) -> str:
        """Folder of the run below that of the sweep."""
        return str(self.config.hydra.sweep.subdir)

    def place(self, subdir: str | None = None) -> Place:
        """Where the run stands, of a sweep in another folder below the sweep's if one is given.

        Raises one of `hydra_errors.EXPECTED` for a value that cannot be resolved.
        """
        HydraConfig.instance().set_config(self.config)
        if self.swept:
            sweep = self.config.hydra.sweep
            if subdir is not None:
                with read_write(sweep):
                    sweep.subdir = subdir
            with read_write(self.config.hydra.runtime), open_dict(self.config.hydra.runtime):
                self.config.hydra.runtime.output_dir = str(Path(str(sweep.dir), str(sweep.subdir)).absolute())
            HydraConfig.instance().set_config(self.config)
        return Place.of(self.case)

    def settings(self) -> Settings:
        """How it is carried out. Raises BadInput."""
        return Settings.of(self.case)
