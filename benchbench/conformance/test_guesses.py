"""Every installed guess against `checks.guesses`."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from benchbench.conformance.candidates import Configured, candidates
from benchbench.conformance.checks.guesses import CHECKS, Guessed
from benchbench.planning.case import Case
from benchbench.planning.guess import straight_line
from benchbench.run import config
from benchbench.storage.recording import write_mcap

GUESSES = pytest.mark.parametrize("candidate", candidates("guesses"), ids=lambda c: c.name)


@pytest.fixture(
    scope="module", params=["static", "circle", "circle vehicle=table1_quaternion dynamics=lie_verlet"]
)
def case(request: pytest.FixtureRequest) -> Case:
    """A target at rest and a moving one, the attitude in angles and as a quaternion, on a coarse grid."""
    return config.compose(*f"+scenario={request.param}".split(), "scenario.intervals=12", "compile=never")


@pytest.fixture(scope="module")
def recording(case: Case, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A recorded plan, for guesses that ask for one."""
    path = tmp_path_factory.mktemp("recording") / "plan.mcap"
    write_mcap(path, straight_line(case), None, case.scenario, case.model, {})
    return path


@pytest.fixture(scope="module")
def known() -> dict[str, Guessed]:
    """What has been guessed so far, by the name of the guess and the recording of its case."""
    return {}


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
@GUESSES
def test_guess(
    candidate: Configured,
    check: Callable[[Guessed], None],
    case: Case,
    recording: Path,
    known: dict[str, Guessed],
) -> None:
    """One check of one guess; a mandatory setting (???) is the path of a recording."""
    asked = {name: str(recording) for name, value in candidate.settings.items() if value == "???"}
    key = f"{candidate.name} {recording}"
    if key not in known:
        known[key] = Guessed(candidate.build(**asked), case)
    check(known[key])
