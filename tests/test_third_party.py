"""A stranger's package with one plugin of each family: one file, one line, and it works everywhere without an edit of ours."""

from __future__ import annotations

import json
import re
import shlex
import subprocess
import sys
import sysconfig
import tomllib
import venv
from pathlib import Path
from typing import Any

import pytest
from sharing import Once

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "examples" / "third_party"
PAGE = (ROOT / "docs" / "add_a_plugin.md").read_text()
FAMILIES = ("relaxations", "dynamics", "guesses", "strategies", "contacts", "motions")
LONGEST = 80
"""Lines of a file."""

PLANS = {
    "relaxation": "+scenario=static relaxation=soft_minimum scenario.intervals=12",
    "strategy": "+scenario=circle strategy=two_grids +scenario/contact=height +scenario.contact_margin.height=0.05",
    "scenario": "+scenario=eight dynamics=lobatto_iiic guess=eased scenario.intervals=30",
}
MISTAKES = {
    "name": "+scenario=static relaxation=soft",
    "field": "+scenario=static strategy=two_grids strategy.shore=0.5",
    "value": "+scenario=static strategy=two_grids strategy.share=2",
    "contact": "+scenario=static +scenario/contact=heigth",
}
PROGRAM = """
import json, sys
import benchbench as bb
from benchbench.run import config
asked = json.load(sys.stdin)
own = "hydra.searchpath=[file://" + asked["own"] + "]"
told = {"plans": {}, "mistakes": {}, "composed": [], "choices": {f: config.choices(f) for f in ("relaxation", "scenario/contact")}}
for overrides in asked["documented"]:
    config.compose_any(*overrides, own)
    told["composed"].append(overrides)
for name, overrides in asked["plans"].items():
    told["plans"][name] = bb.plan(*overrides.split(), own).record
for name, overrides in asked["mistakes"].items():
    try:
        config.compose(*overrides.split())
    except bb.BadInput as mistake:
        told["mistakes"][name] = str(mistake)
print(json.dumps(told, default=str))
"""


@pytest.fixture(scope="module")
def python(once: Once) -> Path:
    """Interpreter of an environment that has our dependencies and the stranger's package."""
    return once("third_party", fresh) / "bin" / "python"


def fresh(folder: Path) -> None:
    venv.create(folder, with_pip=False)
    found = folder / "bin" / "python"
    where = "import sysconfig; print(sysconfig.get_path('purelib'))"
    site = Path(subprocess.check_output([found, "-c", where], text=True).strip())
    ours = sysconfig.get_path("purelib")
    (site / "ours.pth").write_text(f"import site; site.addsitedir({ours!r})\n")
    pip = [sys.executable, "-m", "pip", "--python", str(found)]
    subprocess.run(
        [*pip, "install", "--quiet", "--no-deps", str(PACKAGE)], check=True, capture_output=True, timeout=300
    )


@pytest.fixture(scope="module")
def told(python: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What comes of the plans, the mistakes and the documented commands, in one interpreter."""
    own = tmp_path_factory.mktemp("own")
    (own / "scenario").mkdir()
    (text,) = re.findall(r"```yaml\n(defaults: \[handover.*?)```", PAGE, re.S)
    (own / "scenario" / "eight.yaml").write_text(text)
    asked = {"own": str(own), "plans": PLANS, "mistakes": MISTAKES, "documented": documented()}
    done = subprocess.run(
        [python, "-c", PROGRAM], input=json.dumps(asked), cwd=own, capture_output=True, text=True,
        timeout=600, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    answer: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return answer


def documented() -> list[list[str]]:
    """Overrides of the commands on the page that plan once."""
    commands = [shlex.split(line) for line in PAGE.splitlines() if line.startswith("python -m benchbench")]
    return [[word for word in words[3:] if "=" in word] for words in commands if "-m" not in words[3:]]


def test_each_plugin_is_one_file_and_one_line() -> None:
    text = (PACKAGE / "pyproject.toml").read_text()
    groups = tomllib.loads(text)["project"]["entry-points"]
    assert set(groups) == {f"benchbench.{family}" for family in FAMILIES}
    files = {
        file.name for file in PACKAGE.rglob("*") if file.is_file() and file.suffix != ".pyc"
    } - {"pyproject.toml", "__init__.py"}  # fmt: skip
    for group, plugins in groups.items():
        ((name, target),) = plugins.items()
        (line,) = [line for line in text.splitlines() if name in line]
        assert group in line and target in line
        module, _, kind = target.partition(":")
        file = PACKAGE / f"{module.replace('.', '/')}.py"
        source = file.read_text()
        assert f"class {kind}(" in source and len(source.splitlines()) <= LONGEST
        files.remove(file.name)
    assert not files, "a plugin needs more than its file and its line"


@pytest.mark.slow
def test_each_plans(told: dict[str, Any]) -> None:
    relaxation, strategy, scenario = (told["plans"][name] for name in ("relaxation", "strategy", "scenario"))
    assert relaxation["relaxation"] == "soft_minimum" and relaxation["claimed_success"]
    assert strategy["strategy"] == "two_grids" and strategy["certified"], strategy["reasons"]
    assert set(strategy["contact_gaps"]) == {"position", "velocity", "heading", "height"}
    assert strategy["contact_gaps"]["height"] <= 0.005
    assert scenario["certified"], scenario["reasons"]
    assert (scenario["dynamics"], scenario["guess"], scenario["scenario"]) == (
        "lobatto_iiic",
        "eased",
        "eight",
    )
    assert scenario["contact_gaps"]["height"] <= 0.005


@pytest.mark.slow
def test_mistakes_are_told_as_ours_are(told: dict[str, Any]) -> None:
    said = told["mistakes"]
    assert "soft_minimum" in told["choices"]["relaxation"] and "height" in told["choices"]["scenario/contact"]
    assert (
        said["name"].startswith("relaxation: 'soft' does not exist; allowed: ")
        and "soft_minimum" in said["name"]
    )
    assert said["field"].startswith("strategy.shore: does not exist, perhaps 'share' is meant")
    assert said["value"].startswith("strategy.share: 2 was given; allowed: a number less than 1")
    assert (
        said["contact"].startswith("scenario/contact: 'heigth' does not exist")
        and "height" in said["contact"]
    )


@pytest.mark.slow
def test_documented_commands_compose(told: dict[str, Any]) -> None:
    assert len(told["composed"]) == len(documented()) >= 4


@pytest.mark.slow
def test_it_sweeps_beside_ours(python: Path, tmp_path: Path) -> None:
    sweep = [
        "-m",
        "+scenario=static",
        "scenario.intervals=12",
        "guess=line",
        "relaxation=scholtes,soft_minimum",
        "picture=false",
        "workers=1",
    ]
    done = run(python, tmp_path, "benchbench", *sweep)
    assert done.returncode in (0, 1), done.stdout + done.stderr
    assert len(list((tmp_path / "results" / "table").glob("*.parquet"))) == 2


@pytest.mark.slow
def test_the_conformance_suite_picks_them_up(python: Path, tmp_path: Path) -> None:
    chosen = "soft_minimum or (lobatto_iiic and (pendulum or table1-)) or eased or two_grids or height"
    done = run(python, tmp_path, "pytest", "--pyargs", "benchbench.conformance", "-k", chosen, "-v")
    assert done.returncode == 0, done.stdout + done.stderr
    for name in ("soft_minimum", "lobatto_iiic", "eased", "two_grids", "height"):
        assert re.search(rf"\[.*{name}.* PASSED", done.stdout), name


def run(python: Path, cwd: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [str(python), "-m", *arguments]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=590, check=False)
