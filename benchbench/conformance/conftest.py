"""Prints what the suites measured below the result."""

from __future__ import annotations

import pytest


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """One line for each measurement that a test recorded with `record_property("measured", ...)`."""
    reports = [r for kind in ("passed", "failed") for r in terminalreporter.stats.get(kind, ())]
    lines = sorted(str(v) for r in reports for k, v in r.user_properties if k == "measured")
    if lines:
        terminalreporter.section("measured by the conformance suites")
    for line in lines:
        terminalreporter.line(line)
