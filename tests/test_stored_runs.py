"""Stored runs again: shown, compared with another, drawn for papers and as films."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from program import assert_refused, told

from benchbench.analysis.pairs import paired

SMALL = ("+scenario=static", "strategy=phases", "strategy.margin=0", "scenario.intervals=12", "picture=false")


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two runs, `runs/one` and `runs/other`, whose end is told differently; the first one's summary is in `said`."""
    folder = tmp_path_factory.mktemp("stored")
    (folder / "said").write_text(told(folder, *SMALL, "hydra.run.dir=results/runs/one").stdout)
    told(folder, *SMALL, "scenario.kappa_init=3", "hydra.run.dir=results/runs/other")
    return folder


def test_a_run_is_shown_as_it_was(results: Path) -> None:
    """By its folder, a file in it, or its name below results; where it lies may be told differently."""
    summary = (results / "said").read_text().partition("files ")[0]
    name = "runs_one"
    listed = told(results, "runs").stdout
    assert name in listed
    for given in ("results/runs/one", "results/runs/one/plan.mcap", name):
        done = told(results, "show", given)
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout.startswith(summary) and "results/runs/one" in done.stdout
    assert_refused(told(results, "show", "runs_nobody"), "runs_nobody", "does not exist")


def test_two_runs_side_by_side(results: Path) -> None:
    done = told(results, "compare", "results/runs/one", "runs_other", "--output", "both.svg")
    assert done.returncode == 0, done.stderr
    rows = {line.split("  ")[0]: line.split()[-3:] for line in done.stdout.splitlines()}
    assert rows["scenario.kappa_init"][-2:] == ["2", "3"]
    assert not any(name.startswith(("relaxation", "vehicle", "output", "hydra")) for name in rows), (
        "chosen alike"
    )
    assert "another task" in done.stdout and done.stdout.endswith("figure  both.svg\n")
    assert (results / "both.svg").read_text().count("<path") > 50


def test_the_same_run_twice_differs_in_nothing(results: Path) -> None:
    done = told(results, "compare", "results/runs/one", "results/runs/one", "--output", "same.png")
    assert "another task" not in done.stdout
    changes = re.findall(r"[+-]\d+\.\d+ %$", done.stdout, re.MULTILINE)
    assert len(changes) > 5 and {*changes} == {"+0.000 %"}
    with Image.open(results / "same.png") as image:
        assert image.width == 2100


def test_two_folders_are_paired_by_what_both_chose(results: Path) -> None:
    done = told(results, "compare", "results", "results", "--output", "pairs.pdf")
    assert done.returncode == 0, done.stderr
    assert "of 2" in done.stdout and (results / "pairs.pdf").read_bytes().startswith(b"%PDF")
    assert_refused(
        told(results, "compare", "results", "results/runs/one"), "results", "the other side is one run"
    )


def test_pairs_tell_what_is_compared_from_what_is_common() -> None:
    """By hand: another solver on two tasks, one run of which has no partner; of a run made twice the newest counts."""
    one = [
        {"scenario": s, "solver": "ipopt", "n": n}
        for n, s in enumerate(("static", "linear", "linear", "circle"))
    ]
    other = [{"scenario": s, "solver": "uno", "n": n} for n, s in enumerate(("linear", "static"))]
    found = paired(one, other)
    assert found.differ == (("solver", ("ipopt",), ("uno",)),)
    assert found.names == ("scenario",) and found.single == (1, 0)
    told_apart = {key: (a["n"], b["n"]) for key, (a, b) in found.pairs.items()}
    assert told_apart == {("static",): (0, 1), ("linear",): (2, 0)}


def test_fonts_are_embedded_and_a_drawing_is_the_same_again(results: Path) -> None:
    for name in ("plan.pdf", "again.pdf", "plan.svg", "again.svg"):
        assert told(results, "draw", "results/runs/one", "--output", name).returncode == 0
    pdf = (results / "plan.pdf").read_bytes()
    assert b"/FontFile2" in pdf and b"/Type3" not in pdf
    assert "<text" not in (results / "plan.svg").read_text(), "letters are drawn"
    for kind in ("pdf", "svg"):
        assert (results / f"plan.{kind}").read_bytes() == (results / f"again.{kind}").read_bytes()


def test_a_film_lasts_as_long_as_the_flight(results: Path) -> None:
    """In real time, and half a second of its end; the vehicle moves."""
    said = told(results, "show", "results/runs/one").stdout
    travel = float(re.findall(r"travel time +(\d+\.\d+)", said)[0])
    assert told(results, "draw", "results/runs/one", "--output", "plan.gif", "--fps", "4").returncode == 0
    with Image.open(results / "plan.gif") as film:
        lasts, first = 0.0, np.asarray(film.convert("RGB"), float)
        for frame in range(film.n_frames):
            film.seek(frame)
            lasts += film.info["duration"] / 1000
        assert lasts == pytest.approx(travel + 0.5, abs=0.5)
        assert np.abs(np.asarray(film.convert("RGB"), float) - first).max() > 100
