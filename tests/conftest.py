"""What all tests have in common."""

from __future__ import annotations

import gc
import os
import sys
from functools import partial
from pathlib import Path

import pytest
from sharing import Once, made_once
from shipped import compose_once

from benchbench.certificate import sequential
from benchbench.run import working

# Libraries read it when they are loaded; one worker per core is enough.
os.environ.setdefault("OMP_NUM_THREADS", "1")
# Tests start hundreds of interpreters: one may compile our files for the next, and pytest keep its rewritten ones.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False
compose_once()
working.SILENT_S = (
    600.0  # what takes long on a busy machine says no more than on another; test_working.py asks for it
)


def pytest_collection_finish() -> None:
    """What has been imported stays: the collector need not look at it again, in a fork of a mutation run least of all."""
    gc.freeze()
    gc.set_threshold(50_000, 20, 20)  # composing makes and drops objects by the ten thousand


LONGEST = (
    "test_hostile",
    "test_launcher",
    "test_tune",
    "test_strategies",
    "test_report",
    "test_third_party",
    "test_cluster",
    "test_face",
    "test_stops",
    "test_identity",
)
"""Files that begin first, so that no core is left waiting for one of their tests in the end."""


SPINNING = "::test_solves_without_structure[sleqp-"
"""Programs so small that this library's timers take seconds of some solves: docs/solvers.md."""


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with what takes longest."""
    for item in items:
        if SPINNING in item.nodeid:
            item.add_marker(pytest.mark.slow)
    order = {name: place for place, name in enumerate(LONGEST)}
    items.sort(key=lambda item: order.get(item.path.stem, len(order)))


@pytest.fixture(scope="session")
def once(tmp_path_factory: pytest.TempPathFactory) -> Once:
    """Make a folder of a name once per session."""
    return partial(made_once, tmp_path_factory.getbasetemp())


@pytest.fixture
def brief_replays(monkeypatch: pytest.MonkeyPatch) -> None:
    """Plans of unfinished solves are not flown to the end of the replay's patience: most of their seconds, and no verdict."""
    monkeypatch.setattr(sequential, "EVALUATIONS", 300)
    monkeypatch.setattr(sequential, "ALLOWANCE", 0)


@pytest.fixture(scope="session")
def calm_sweep(once: Once) -> Path:
    """A small sweep that nothing disturbed."""
    from sweeps import calm

    return once("calm_sweep", calm)
