"""`benchbench draw`: the pictures that runs of a sweep leave for later."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from program import assert_refused, records, told

from benchbench.ground.arrays import Array

SMALL = ("+scenario=static", "strategy=phases", "strategy.margin=0", "scenario.intervals=12")


def pixels(path: Path) -> Array:
    with Image.open(path) as image:
        return np.asarray(image, float)


@pytest.fixture(scope="module")
def single(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a single run, which draws by itself."""
    folder = tmp_path_factory.mktemp("single")
    told(folder, *SMALL)
    (path,) = folder.rglob("plan.png")
    return path.parent


def test_a_picture_drawn_later_is_the_same(single: Path) -> None:
    """From the folder or the recording, and in place of one that is there."""
    path = single / "plan.png"
    first = pixels(path)
    path.unlink()
    assert told(single, "draw", str(single)).stdout.splitlines() == [str(path), "1 picture drawn"]
    np.testing.assert_array_equal(pixels(path), first)
    path.write_bytes(b"no picture")
    assert told(single, "draw", str(single / "plan.mcap")).returncode == 0
    np.testing.assert_array_equal(pixels(path), first)


def test_a_sweep_draws_when_it_is_asked(tmp_path: Path) -> None:
    """Not by itself; then all that are missing below a folder; or by resuming, which runs nothing again."""
    sweep = ("-m", *SMALL, "seed=0,1", "workers=1")
    told(tmp_path, *sweep)
    before = sorted(record["run_id"] for record in records(tmp_path))
    assert len(before) == 2 and not list(tmp_path.rglob("plan.png"))
    done = told(tmp_path, "draw", "results")
    drawn = sorted(tmp_path.rglob("plan.png"))
    assert len(drawn) == 2 and done.stdout.endswith("2 pictures drawn\n")
    assert told(tmp_path, "draw", "results").stdout == "0 pictures drawn\n"
    drawn[0].unlink()
    said = told(tmp_path, *sweep, "picture=true").stdout
    assert "2 of 2 runs are in the table and are skipped" in said and drawn[0].is_file()
    assert sorted(record["run_id"] for record in records(tmp_path)) == before


def test_what_cannot_be_drawn_is_bad_input(single: Path, tmp_path: Path) -> None:
    assert_refused(told(tmp_path, "draw", "nowhere"), "nowhere", "does not exist")
    (tmp_path / "empty").mkdir()
    assert_refused(told(tmp_path, "draw", "empty"), "empty", "holds no plan")
    (tmp_path / "half").mkdir()
    (tmp_path / "half" / "plan.mcap").write_bytes((single / "plan.mcap").read_bytes())
    assert_refused(told(tmp_path, "draw", "half"), "half", "has no config.yaml")
    (tmp_path / "half" / "config.yaml").write_bytes((single / "config.yaml").read_bytes())
    assert_refused(told(tmp_path, "draw", "half"), "half", "cannot be read")
