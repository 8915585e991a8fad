"""What all tests have in common."""

from __future__ import annotations

import gc
import os
from functools import partial
from pathlib import Path

import pytest
from sharing import Once, made_once

os.environ.setdefault(
    "OMP_NUM_THREADS", "1"
)  # libraries read it when they are loaded; one worker per core is enough
os.environ.pop(
    "PYTHONDONTWRITEBYTECODE", None
)  # tests start hundreds of interpreters, one may compile our files


def pytest_collection_finish() -> None:
    """What has been imported stays: the collector need not look at it again, in a fork of a mutation run least of all."""
    gc.freeze()


@pytest.fixture(scope="session")
def once(tmp_path_factory: pytest.TempPathFactory) -> Once:
    """Make a folder of a name once per session."""
    return partial(made_once, tmp_path_factory.getbasetemp())


@pytest.fixture(scope="session")
def calm_sweep(once: Once) -> Path:
    """A small sweep that nothing disturbed."""
    from sweeps import calm

    return once("calm_sweep", calm)
