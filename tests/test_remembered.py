"""What took long to find out is remembered until something changes that it depends on, and trusted where it is private."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from benchbench.cli.remembered import keep, recall
from benchbench.run.choices import folder

LINES = ["solver", "  ipopt  built-in  the default"]


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    place = tmp_path / "cache"
    monkeypatch.setenv("BENCHBENCH_CACHE", str(place))
    return place


def test_nothing_is_remembered_that_was_not_kept() -> None:
    assert recall("list") is None
    keep("list", LINES)
    assert recall("list") == LINES and recall("other") is None


@pytest.mark.parametrize("change", ["library path", "licence", "distribution", "configuration"])
def test_a_change_of_the_environment_is_noticed(
    change: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    keep("list", LINES)
    with monkeypatch.context() as patch:
        if change == "library path":
            patch.setenv("LD_LIBRARY_PATH", str(tmp_path))
        elif change == "licence":
            patch.setenv("ARTELYS_LICENSE", "abc")
        elif change == "distribution":
            (tmp_path / "site" / "solver-1.0.dist-info").mkdir(parents=True)
            patch.syspath_prepend(str(tmp_path / "site"))
        else:
            own = tmp_path / "conf"
            own.mkdir()
            for name in ("config.yaml", "more.yaml"):
                (own / name).write_text("x: 1" if name == "more.yaml" else Path(folder(), name).read_text())
            patch.setenv("BENCHBENCH_CONF", str(own))
            keep("list", LINES)
            (own / "more.yaml").write_text("x: 22")
        assert recall("list") is None
    if change != "configuration":
        assert recall("list") == LINES, "as it was"


def test_only_the_newest_environment_is_kept(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for number in range(3):
        monkeypatch.setenv("LD_LIBRARY_PATH", f"/nowhere/{number}")
        keep("list", [str(number)])
    assert len(list(cache.iterdir())) == 1 and recall("list") == ["2"]


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="no owners")
def test_a_file_that_others_may_write_is_not_believed(cache: Path) -> None:
    keep("list", LINES)
    (path,) = cache.iterdir()
    path.chmod(0o666)
    assert recall("list") is None
    path.chmod(0o600)
    path.write_text("{broken")
    assert recall("list") is None
