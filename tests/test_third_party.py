"""A stranger's package, installed into a fresh environment, works everywhere without an edit of ours."""

from __future__ import annotations

import subprocess
import sys
import sysconfig
import venv
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "examples" / "third_party"


@pytest.fixture(scope="module")
def python(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Interpreter of an environment that has our dependencies and the stranger's package."""
    folder = tmp_path_factory.mktemp("fresh")
    venv.create(folder, with_pip=False)
    found = folder / "bin" / "python"
    where = "import sysconfig; print(sysconfig.get_path('purelib'))"
    site = Path(subprocess.check_output([found, "-c", where], text=True).strip())
    ours = sysconfig.get_path("purelib")
    (site / "ours.pth").write_text(f"import site; site.addsitedir({ours!r})\n")
    pip = [
        sys.executable,
        "-m",
        "pip",
        "--python",
        str(found),
        "install",
        "--quiet",
        "--no-deps",
        str(PACKAGE),
    ]
    subprocess.run(pip, check=True, capture_output=True, timeout=300)
    return found


def run(python: Path, cwd: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [str(python), "-m", *arguments]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=300, check=False)


def test_it_plans_a_flight(python: Path, tmp_path: Path) -> None:
    done = run(python, tmp_path, "benchbench", "+scenario=static", "relaxation=soft_minimum", "time_limit=30")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "certified" in done.stdout


def test_it_sweeps_beside_ours(python: Path, tmp_path: Path) -> None:
    sweep = ["-m", "+scenario=static", "scenario.intervals=20", "relaxation=scholtes,soft_minimum"]
    done = run(python, tmp_path, "benchbench", *sweep)
    assert done.returncode in (0, 1), done.stdout + done.stderr
    assert len(list((tmp_path / "results" / "table").glob("*.parquet"))) == 2


def test_a_misspelt_name_lists_it(python: Path, tmp_path: Path) -> None:
    done = run(python, tmp_path, "benchbench", "+scenario=static", "relaxation=soft")
    assert done.returncode == 2
    assert "soft_minimum" in done.stderr


def test_the_conformance_suite_picks_it_up(python: Path, tmp_path: Path) -> None:
    done = run(python, tmp_path, "pytest", "--pyargs", "benchbench.conformance", "-k", "soft_minimum", "-q")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "passed" in done.stdout
