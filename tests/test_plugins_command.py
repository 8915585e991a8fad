"""`benchbench plugins`, as a user runs it."""

from __future__ import annotations

from importlib.metadata import entry_points
from pathlib import Path

import pytest
from program import told


@pytest.fixture(scope="module")
def printed(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """Lines of the whole list, found out anew; asked again, it is remembered, and the same."""
    folder = tmp_path_factory.mktemp("plugins")
    done = told(folder, "plugins", "--anew")
    assert done.returncode == 0, done.stderr
    assert not done.stderr or done.stderr.startswith("benchbench: trying"), "only where it takes long"
    again = told(folder, "plugins")
    assert (again.stdout, again.stderr) == (done.stdout, "")
    return done.stdout.splitlines()


def test_every_installed_plugin_has_a_line(printed: list[str]) -> None:
    lines = [line.split() for line in printed]
    named = {words[0] for words in lines if words}
    for family in ("dynamics", "relaxations", "solvers"):
        found = {entry.name for entry in entry_points(group=f"benchbench.{family}")}
        assert found and found <= named


def test_a_missing_library_is_told_with_its_remedy(printed: list[str]) -> None:
    line = next(x for x in printed if "worhp" in x)
    assert "NOT AVAILABLE HERE" in line and "remedy: " in line


def test_settings_of_a_solver_by_accuracy(tmp_path: Path) -> None:
    done = told(tmp_path, "plugins", "solver=ipopt")
    rows = {words[0]: words[1:] for line in done.stdout.splitlines() if (words := line.split())}
    assert rows["option"] == ["accuracy=low", "accuracy=medium", "accuracy=high"]
    low, medium, high = map(float, rows["tol"])
    assert low > medium > high > 0.0


def test_unknown_plugin(tmp_path: Path) -> None:
    done = told(tmp_path, "plugins", "solver=ipop")
    assert done.returncode == 2
    assert "ipop" in done.stderr and "allowed" in done.stderr
