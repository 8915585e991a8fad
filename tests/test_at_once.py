"""What is answered before the program behind it is imported: the same choices and options as Hydra finds."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from hydra._internal.utils import get_args_parser
from program import assert_refused, told

from benchbench.cli import at_once
from benchbench.run import choices, config

SMALL = ("+scenario=static", "strategy=phases", "strategy.margin=0", "scenario.intervals=12", "picture=false")
HEAVY = {"numpy", "scipy", "pandas", "casadi", "hydra", "pydantic", "pyarrow", "matplotlib", "omegaconf"}
LATER = {"scipy", "pandas", "matplotlib"}


@pytest.mark.parametrize("family", [*choices.FAMILIES, "peer"])
def test_choices_are_those_that_hydra_finds(family: str) -> None:
    assert choices.choices(family) == config.choices(family)


def test_families_and_options_are_all_there_are() -> None:
    assert tuple(config.KINDS) == choices.FAMILIES
    options = {name for action in get_args_parser()._actions for name in action.option_strings}
    ours = {"--version", "--traceback"}
    assert {name for name in options if name.startswith("--")} | ours == {*at_once.LONG}
    assert {*at_once.ELSEWHERE} < options


def test_own_configuration_counts(tmp_path: Path) -> None:
    """For the help and for what is refused, in both ways to write the option."""
    (tmp_path / "own" / "vehicle").mkdir(parents=True)
    (tmp_path / "own" / "vehicle" / "mine.yaml").write_text("x: 1")
    for option in (["--config-dir", "own"], ["--config-dir=own"], ["-cd", "own"]):
        assert "mine" in told(tmp_path, "--help", *option).stdout
        assert_refused(
            told(tmp_path, *option, "+scenario=static", "vehicle=other"), "vehicle", "'other' does not exist"
        )
        done = told(tmp_path, *option, "+scenario=static", "vehicle=mine", "time_limit=-1")
        assert_refused(done, "time_limit")


def test_what_is_not_plain_is_left_to_hydra(tmp_path: Path) -> None:
    """Several choices, a nested one, one that is taken away, another configuration."""
    for asked in (
        ["-m", "solver=nope"], ["solver=ipopt,nope"], ["strategy@strategy.of=nope"], ["solver=null"], ["~solver"],
        ["solver=nope", "hydra.searchpath=[file:///elsewhere]"], ["--config-name", "x", "solver=nope"],
    ):  # fmt: skip
        assert at_once.answer(["+scenario=static", *asked]) is None


def imported(*arguments: str, folder: Path) -> set[str]:
    """Packages that the program imports."""
    command = [sys.executable, "-X", "importtime", "-m", "benchbench", *arguments]
    told = subprocess.run(command, capture_output=True, text=True, cwd=folder, check=False).stderr
    lines = [line for line in told.splitlines() if line.startswith("import time:")]
    return {line.rpartition("|")[2].strip().partition(".")[0] for line in lines}


def test_help_imports_nothing_heavy(tmp_path: Path) -> None:
    assert not HEAVY & imported("--help", folder=tmp_path)


def test_a_plain_run_imports_nothing_that_it_does_not_need(tmp_path: Path) -> None:
    found = imported(*SMALL, folder=tmp_path)
    assert {"casadi", "hydra", "pyarrow"} < found and not LATER & found
