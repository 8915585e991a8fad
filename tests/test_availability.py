"""Whether a backend works here is asked in a child, whose every end is an answer."""

from __future__ import annotations

import pytest

from benchbench.nlp.availability import Availability, ask


@pytest.mark.parametrize(
    ("question", "reason"),
    [
        ("licence", "refuses: licence"),
        ("segfault", "it ends the process (SIGSEGV)"),
        ("leaves", "it ends the process (exit code 0)"),
        ("hangs", "a tiny problem was not solved within 2 s"),
        ("raises", "ImportError: libmissing.so: no such file"),
    ],
)
def test_every_end_is_an_answer(question: str, reason: str) -> None:
    assert ask("bad_backend", question, seconds=2.0 if question == "hangs" else 60.0) == Availability(
        False, reason
    )


def test_what_works_may_print(capfd: pytest.CaptureFixture[str]) -> None:
    assert ask("bad_backend", "works") == Availability(True)
    assert capfd.readouterr() == ("", "")
