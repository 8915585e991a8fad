"""The cache of block derivatives: reused, repaired, shared between processes, and never needed."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from benchbench.blocks import Derivatives, cache_root, derivatives

Z = np.array([0.3, -1.2, 0.8])


def curved(name: str = "curved", factor: float = 2.0) -> ca.Function:
    z, p, s = ca.SX.sym("z", 3), ca.SX.sym("p", 1), ca.SX.sym("sigma")
    out = ca.vertcat(ca.sin(z[0] * z[1]) + s, p * z[2] ** 3 + factor * z[0], z[1])
    return ca.Function(name, [z, p, s], [out])


def check(found: Derivatives) -> None:
    """Value and derivatives at one point, worked out by hand for factor 2, p = 5, sigma = 0.1."""
    a, b, c = Z
    value = np.asarray(found.value(Z, 5.0, 0.1)).ravel()
    np.testing.assert_allclose(value, [np.sin(a * b) + 0.1, 5 * c**3 + 2 * a, b], rtol=1e-14)
    jacobian = np.zeros((3, 3))
    jacobian[found.rows, found.columns] = np.asarray(found.jacobian(Z, 5.0, 0.1)).ravel()
    cos, sin = np.cos(a * b), np.sin(a * b)
    np.testing.assert_allclose(jacobian, [[b * cos, a * cos, 0], [2, 0, 15 * c**2], [0, 1, 0]], rtol=1e-14)
    hessian = np.zeros((3, 3))
    entries = np.asarray(found.hessian(Z, 5.0, 0.1, [1.0, 10.0, 7.0])).ravel()
    hessian[found.hessian_rows, found.hessian_columns] = entries
    upper = [[-b * b * sin, cos - a * b * sin, 0], [0, -a * a * sin, 0], [0, 0, 300 * c]]
    np.testing.assert_allclose(hessian, upper, rtol=1e-13, atol=1e-14)


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
@pytest.mark.parametrize("name", ["functions.casadi", "block.so"])
def test_damaged_entry_is_made_again(root: Path, name: str, damage: str) -> None:
    """In a process of its own: a truncated library kills whoever loads it."""
    needs_gcc()
    derivatives([curved()])
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
    code = "import test_blocks_cache as t; d, = t.derivatives([t.curved()]); t.check(d); assert d.compiled"
    return subprocess.Popen([sys.executable, "-c", code], cwd=Path(__file__).parent)


def test_two_processes_at_once(root: Path) -> None:
    needs_gcc()
    both = [elsewhere(), elsewhere()]
    assert [process.wait(60) for process in both] == [0, 0]
    assert len(list(root.rglob("block.so"))) == 1
    leftovers = {p.name for p in root.rglob("*") if p.is_file()}
    assert leftovers == {"functions.casadi", "functions.casadi.sha256", "block.so", "block.so.sha256"}


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
