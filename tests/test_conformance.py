"""The registry and the public conformance suites: what is installed is found, tested, and reported when broken."""

from __future__ import annotations

import importlib
import inspect
import os
import pkgutil
import subprocess
import sys
from pathlib import Path

import pytest
from packages import install

import benchbench_plugins
from benchbench.conformance.candidates import GROUPS, Configured, candidates
from benchbench.flight.autopilot import Autopilot
from benchbench.flight.controller import Controller
from benchbench.flight.payload import Payload
from benchbench.flight.predictor import Predictor
from benchbench.flight.residual import Residual
from benchbench.flight.world import World
from benchbench.ground.registry import FAMILIES, installed
from benchbench.mpcc.ready import ReadyMade
from benchbench.nlp.relaxation import Relaxation
from benchbench.nlp.solver import Solver
from benchbench.ocp.contact import Contact
from benchbench.ocp.model import Model
from benchbench.ocp.motion import Motion
from benchbench.ocp.scenario import Scenario
from benchbench.ocp.task_family import TaskFamily
from benchbench.planning.case import Guess, Strategy
from benchbench.planning.peer import Peer
from benchbench.transcription.dynamics import Dynamics
from benchbench_plugins.solvers.nlpsol import Nlpsol

BASES = {
    "models": Model, "dynamics": Dynamics, "contacts": Contact, "motions": Motion, "relaxations": Relaxation,
    "solvers": Solver, "strategies": Strategy, "guesses": Guess, "peers": Peer,
    "collections": ReadyMade, "scenarios": Scenario, "task_families": TaskFamily,
    "worlds": World, "controllers": Controller, "autopilots": Autopilot, "residuals": Residual, "payloads": Payload,
    "predictors": Predictor,}  # fmt: skip


def written(family: str) -> set[type]:
    """Every class of a family that is defined in the built-in plugin package."""
    found = set()
    folder = f"{benchbench_plugins.__name__}.{family}"
    for module in pkgutil.iter_modules(importlib.import_module(folder).__path__, f"{folder}."):
        members = inspect.getmembers(importlib.import_module(module.name), inspect.isclass)
        found |= {
            kind for _, kind in members if issubclass(kind, BASES[family]) and kind.__module__ == module.name
        }
    return found


@pytest.mark.parametrize("family", sorted(set(FAMILIES) - {"scenarios"}))  # those are part of the core
def test_every_built_in_plugin_is_registered(family: str) -> None:
    """A class without an entry point would never be tested; the package must be installed again after adding one."""
    ours = {p.kind for p in installed(family) if p.distribution == "benchbench"}
    assert ours == written(family) - {Nlpsol}  # for what is not available here


@pytest.mark.parametrize("family", FAMILIES)
def test_the_registry_describes_plugins(family: str) -> None:
    for plugin in installed(family):
        assert plugin.error == ""
        assert plugin.summary.strip() and plugin.target.count(":") == 1
        assert plugin.kind is not None and issubclass(plugin.kind, BASES[family])


def test_unknown_family_is_refused() -> None:
    with pytest.raises(ValueError, match="relaxations"):
        installed("relaxation")


@pytest.mark.parametrize("family", GROUPS)
def test_every_installed_plugin_is_a_candidate(family: str) -> None:
    assert {p.kind for p in installed(family)} <= {c.kind for c in candidates(family)}
    names = [c.name for c in candidates(family)]
    assert len(set(names)) == len(names)


THEIRS = '''
"""A third party's relaxations."""
import numpy as np
from benchbench.nlp.relaxation import Relaxation, Relaxed

class Theirs(Relaxation):
    """Product of the pair below sigma times a scale."""
    schedule = (1e-1, 1e-3, 1e-5, 1e-7)
    def __init__(self, scale, offset):
        self.scale, self.offset = scale, offset
    def relax(self, g, h, sigma, kind, gap):
        return Relaxed(g * h - self.scale * sigma - self.offset, (-np.inf,), (0.0,))

class Bare(Theirs):
    """Cannot be built without its arguments, and no YAML names it."""
'''


@pytest.fixture
def third_party(tmp_path: Path) -> Path:
    """An installed distribution: a module, a config package, entry points."""
    (tmp_path / "theirs.py").write_text(THEIRS)
    conf = tmp_path / "their_conf" / "relaxation"
    conf.mkdir(parents=True)
    (tmp_path / "their_conf" / "__init__.py").touch()
    (conf / "theirs.yaml").write_text("_target_: theirs.Theirs\nscale: 1.0\noffset: 0.0\n")
    (conf / "spoilt.yaml").write_text("_target_: theirs.Theirs\nscale: 1.0\noffset: 0.01\n")
    (conf / "typo.yaml").write_text("_target_: theirs.Thiers\n")
    (conf / "torn.yaml").write_text("_target_: [theirs\n")
    theirs = {
        "theirs": "theirs:Theirs", "bare": "theirs:Bare", "gone": "theirs:Gone", "missing": "not_there:Any", "function": "theirs:np",
    }  # fmt: skip
    groups = {"benchbench.conf": {"theirs": "their_conf"}, "benchbench.relaxations": theirs}
    return install(tmp_path, "their-package", groups)


def run(third_party: Path, *arguments: str) -> str:
    """Run Python elsewhere, with the third party's package on its path; returns what it prints."""
    path = os.pathsep.join([str(third_party), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [sys.executable, *arguments], cwd=third_party, env=os.environ | {"PYTHONPATH": path, "COLUMNS": "300"},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    return done.stdout + done.stderr


def test_a_broken_entry_point_is_an_answer(third_party: Path) -> None:
    lines = run(
        third_party, "-c",
        "from benchbench.ground.registry import installed\n"
        "for p in installed('relaxations'): print(p.name, p.distribution, bool(p.kind), p.summary or p.error, sep=' | ')",
    ).splitlines()  # fmt: skip
    found = {line.split(" | ")[0]: line for line in lines}
    assert found["theirs"] == "theirs | their-package | True | Product of the pair below sigma times a scale."
    assert found["gone"].startswith("gone | their-package | False | AttributeError")
    assert found["missing"].startswith("missing | their-package | False | ModuleNotFoundError")
    assert found["function"].startswith("function | their-package | False | theirs:np is no class")
    assert "scholtes | benchbench | True" in found["scholtes"]


def test_a_third_partys_plugins_are_tested_because_they_are_installed(third_party: Path) -> None:
    """Its good configuration passes; the spoilt, misspelt, torn, unbuildable and missing ones fail by name."""
    out = run(
        third_party, "-m", "pytest", "--pyargs", "benchbench.conformance.test_relaxations", "-rfEs", "--tb=line",
        "-p", "no:cacheprovider", "-k", "theirs or typo or torn or bare or gone or missing or function",
    )  # fmt: skip
    failed = {
        line.split("[")[1].split("-")[0]
        for line in out.splitlines()
        if line.startswith("FAILED") and "[" in line
    }
    assert failed == {"theirs", "typo", "torn", "bare", "gone", "missing", "function"}, out
    good = [line for line in out.splitlines() if line.startswith("FAILED") and "[theirs-" in line]
    assert good and all("[theirs-spoilt-" in line for line in good), out
    assert "theirs, strict: " in out, "measurements are printed"
    assert "12 passed" in out, out


@pytest.mark.slow
def test_the_suites_collect_every_plugin(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "--pyargs", "benchbench.conformance", "--collect-only", "-q"],
        cwd=tmp_path, capture_output=True, text=True, check=True,
    )  # fmt: skip
    for family in GROUPS:
        for plugin in installed(family):
            tests = [line for line in done.stdout.splitlines() if f"test_{family}.py" in line]
            assert any(f"[{plugin.name}" in line or f"-{plugin.name}" in line for line in tests), plugin.name


def test_a_plugin_whose_numbers_no_configuration_has_is_told_so() -> None:
    class Machine:
        def __init__(self, name: str, mass: float, damping: float = 0.0) -> None:
            self.name, self.mass, self.damping = name, mass, damping

    bare = Configured("machine", Machine, {})
    with pytest.raises(
        AssertionError, match="Machine has no default for name, mass, and no configuration names it"
    ):
        bare.build()
