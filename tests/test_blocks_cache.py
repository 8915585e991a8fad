"""The cache of block derivatives: reused, repaired, shared between processes, and never needed."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from curved import check, curved

from benchbench.formulation.handover import free_contact, phases
from benchbench.mpcc.cache import cache_root
from benchbench.mpcc.derivatives import derivatives
from benchbench.nlp.program import assemble
from benchbench.nlp.relaxation import relax
from benchbench.planning.guess import straight_line
from benchbench.run import config


@pytest.fixture(autouse=True)
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "cache"
    monkeypatch.setenv("BENCHBENCH_CACHE", str(folder))
    return folder


def files(root: Path) -> dict[Path, tuple[int, int]]:
    """Every file with what changes when it is written again."""
    return {p: (p.stat().st_ino, p.stat().st_mtime_ns) for p in root.rglob("*") if p.is_file()}


def only(root: Path, name: str) -> Path:
    (path,) = root.rglob(name)
    return path


def needs_gcc() -> None:
    if not shutil.which("gcc"):
        pytest.skip("no gcc here")


def test_compiled_and_interpreted_say_the_same() -> None:
    (plain,) = derivatives([curved()], "never")
    check(plain)
    assert not plain.compiled
    needs_gcc()
    (fast,) = derivatives([curved()])
    check(fast)
    assert fast.compiled


def test_second_call_writes_nothing(root: Path) -> None:
    derivatives([curved(), curved()])
    before = files(root)
    assert len([p for p in before if p.name == "functions.casadi"]) == 1, "equal functions share one entry"
    check(derivatives([curved()])[0])
    assert files(root) == before


def test_second_call_needs_no_compiler(monkeypatch: pytest.MonkeyPatch) -> None:
    needs_gcc()
    derivatives([curved()])
    monkeypatch.setenv("PATH", "")
    assert derivatives([curved()])[0].compiled


def test_what_is_loaded_is_kept_while_its_entry_stands(root: Path) -> None:
    (first,) = derivatives([curved()], "never")
    assert derivatives([curved()], "never")[0] is first
    shutil.rmtree(only(root, "pattern.npz").parent)
    again = derivatives([curved()], "never")[0]
    assert again is not first
    check(again)


def test_other_numbers_are_another_entry(root: Path) -> None:
    derivatives([curved(), curved(factor=3.0), curved("other")], "never")
    assert len(list(root.rglob("functions.casadi"))) == 3


def test_without_compiler_it_is_interpreted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    (found,) = derivatives([curved()])
    check(found)
    assert not found.compiled


def test_failing_compiler_is_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    gcc = tmp_path / "gcc"
    gcc.write_text("#!/bin/sh\necho no space left >&2\nexit 1\n")
    gcc.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    (found,) = derivatives([curved()])
    check(found)
    assert not found.compiled
    assert "no space left" in caplog.text


@pytest.mark.parametrize("damage", ["truncated", "garbled", "unsealed"])
@pytest.mark.parametrize("name", ["functions.casadi", "pattern.npz", "block.so"])
def test_damaged_entry_is_made_again(root: Path, name: str, damage: str) -> None:
    """In a process of its own: a truncated library kills whoever loads it."""
    needs_gcc()
    assert elsewhere().wait(60) == 0
    path = only(root, name)
    content = path.read_bytes()
    half = len(content) // 2
    match damage:
        case "truncated":
            path.write_bytes(content[:half])
        case "garbled":
            path.write_bytes(content[:half] + bytes([content[half] ^ 1]) + content[half + 1 :])
        case "unsealed":
            path.with_name(f"{name}.sha256").unlink()
    assert elsewhere().wait(60) == 0
    before = files(root)
    check(derivatives([curved()])[0])
    assert files(root) == before, "the other process repaired it"


def elsewhere() -> subprocess.Popen[bytes]:
    """Check the derivatives in another process; it exits with 0 when they are right and compiled."""
    code = "import curved as t; d, = t.derivatives([t.curved()]); t.check(d); assert d.compiled"
    return subprocess.Popen([sys.executable, "-c", code], cwd=Path(__file__).parent)


@pytest.fixture
def compilers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[], int]:
    """How many times gcc was called, by any process, from now on."""
    needs_gcc()
    calls = tmp_path / "calls"
    counting = tmp_path / "bin" / "gcc"
    counting.parent.mkdir()
    counting.write_text(f'#!/bin/sh\necho called >> "{calls}"\nexec "{shutil.which("gcc")}" "$@"\n')
    counting.chmod(0o755)
    monkeypatch.setenv("PATH", str(counting.parent), prepend=os.pathsep)
    return lambda: len(calls.read_text().splitlines()) if calls.exists() else 0


@pytest.mark.slow
def test_many_processes_at_a_cold_cache(root: Path, compilers: Callable[[], int]) -> None:
    several = [elsewhere() for _ in range(6)]
    assert [process.wait(120) for process in several] == [0] * 6
    assert compilers() == 1, "the others waited and took what the first one made"
    made = {p.name for p in root.rglob("*") if p.is_file()} - {"lock"}
    assert made == {
        f"{n}{s}" for n in ("functions.casadi", "pattern.npz", "block.so") for s in ("", ".sha256")
    }


def test_what_is_solved_often_is_compiled_better_once(root: Path, compilers: Callable[[], int]) -> None:
    """Beside the other library, and with the same numbers to the last bit."""
    quick, fast = derivatives([curved()])[0], derivatives([curved()], "optimised")[0]
    check(fast)
    assert fast.compiled and compilers() == 2 and only(root, "block.so").with_name("fast.so").exists()
    derivatives([curved()], "optimised"), derivatives([curved()])
    assert compilers() == 2
    point = np.random.default_rng(0).normal(size=(3, 50))
    for one, other, more in (
        (quick.value, fast.value, ()), (quick.jacobian, fast.jacobian, ()), (quick.hessian, fast.hessian, (point + 1,)),
    ):  # fmt: skip
        np.testing.assert_array_equal(
            one.map(50)(point, 5.0, 0.1, *more), other.map(50)(point, 5.0, 0.1, *more)
        )


def test_a_process_killed_while_compiling_blocks_nobody(
    root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    needs_gcc()
    started, slow = tmp_path / "started", tmp_path / "slow" / "gcc"
    slow.parent.mkdir()
    slow.write_text(f'#!/bin/sh\ntouch "{started}"\nexec sleep 60\n')
    slow.chmod(0o755)
    with monkeypatch.context() as patch:
        patch.setenv("PATH", str(slow.parent), prepend=os.pathsep)
        dying = subprocess.Popen(
            [sys.executable, "-c", "import curved as t; t.derivatives([t.curved()])"],
            cwd=Path(__file__).parent, start_new_session=True,
        )  # fmt: skip
        while not started.exists():
            assert dying.poll() is None
            time.sleep(0.05)
    os.killpg(dying.pid, signal.SIGKILL)
    dying.wait(10)
    assert elsewhere().wait(60) == 0


def test_one_compilation_for_a_whole_handover_sweep(root: Path, compilers: Callable[[], int]) -> None:
    """Other N, contact length, bounds, target of the same kind and guess: nothing is differentiated or compiled."""

    def prepare(*overrides: str) -> None:
        case = config.compose("+scenario=circle", *overrides)
        line = straight_line(case)
        for mpcc in (phases(case, line).mpcc, relax(free_contact(case, line).mpcc, case.relaxation)):
            assert assemble(mpcc).compiled

    prepare("scenario.intervals=30")
    before, compiled = files(root), compilers()
    assert compiled > 0
    prepare(
        "scenario.intervals=70", "scenario.kappa_init=13", "scenario.target.rate_radps=-0.4",
        "scenario.target.centre_m=[1.2,0.1,0.5]", "scenario.travel_time=[0.5,9.0]", "scenario.workspace.z=[0.1,1.2]",
        "scenario.travel_time_guess=4.0", "scenario.contact_guess=0.5", "scenario.end.x=2.2",
    )  # fmt: skip
    assert compilers() == compiled
    assert files(root) == before


def test_blocks_with_little_work_are_not_compiled(compilers: Callable[[], int]) -> None:
    (found,) = derivatives([curved()], instances=[1000])
    check(found)
    assert found.compiled, "as fast as it would be"
    assert compilers() == 0


def test_unwritable_cache_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "file").write_text("not a folder")
    refused = tmp_path / "file" / "cache"
    monkeypatch.setenv("BENCHBENCH_CACHE", str(refused))
    check(derivatives([curved(), curved("other")])[0])
    assert cache_root() == cache_root() != refused
    assert [r.message for r in caplog.records if str(refused) in r.message] != []
    assert len(caplog.records) == 1, "said once, with the remedy"
    assert "BENCHBENCH_CACHE" in caplog.text
