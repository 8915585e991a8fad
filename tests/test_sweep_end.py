"""What a sweep shows: rows that stand clear of the bar on a terminal, and at its end what one needs."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest
from program import listen, on_terminal, told

SWEEP = ("-m", "+scenario=static", "strategy=phases", "strategy.margin=0", "scenario.intervals=12", "workers=1",
         "solver=ipopt,knitro")  # fmt: skip


def seen(heard: str) -> list[str]:
    """Lines as a terminal is left with them: a carriage return and the code to erase take away what stands in the line."""
    lines = [line.rpartition("\x1b[2K")[2] for line in heard.replace("\r\n", "\n").split("\n")]
    return [re.sub(r"\x1b\[[?\d;]*[A-Za-z]|\r", "", line).rstrip() for line in lines]


@pytest.mark.skipif(os.name != "posix", reason="no pseudo-terminal")
def test_rows_stand_clear_of_the_bar_and_a_missing_solver_is_unavailable(tmp_path: Path) -> None:
    with on_terminal(tmp_path, *SWEEP) as (process, terminal):
        lines = seen(listen(terminal))
        assert process.wait() == 2
    if not any("knitro: " in line for line in lines):
        pytest.skip("there is a Knitro")
    assert any(re.match(r" +1  NOT: uncertified +\d\.\d{4} s .*solver=ipopt$", line) for line in lines), lines
    assert any(re.match(r"benchbench: unavailable \(run 2: solver=knitro\)$", line) for line in lines), lines
    assert not any("bad input" in line for line in lines)
    assert not [line for line in lines if "━" in line and line.rstrip("━ ").split("━")[-1].count("  ") > 1], (
        lines
    )


def test_the_end_says_what_came_out_why_not_and_where(tmp_path: Path) -> None:
    """Again, it shows the rows that it skipped."""
    first = told(tmp_path, *SWEEP).stdout.splitlines()
    again = told(tmp_path, *SWEEP).stdout.splitlines()
    row = next(line for line in first if "NOT: uncertified" in line)
    assert row in again, "the row of a run that is skipped"
    assert "2 of 2 runs are in the table and are skipped; rerun=all runs them again" in again
    for lines in (first, again):
        assert next(line for line in lines if line.startswith("static")).split()[1:4] == ["0", "of", "2"]
        assert any(re.match(r" +1  uncertified: .+ allowed .+\(solver=ipopt\)$", line) for line in lines)
        assert lines[-3:] == [
            "results  results",
            "report   benchbench report results",
            "0 of 2 runs certified",
        ]
