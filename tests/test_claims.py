"""The ledger of claims: docs and report say what it says, and its commands are ones that can be typed."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest

from benchbench.ground.errors import BadInput
from benchbench.ground.families import FLOWN
from benchbench.report.claims import load, markdown
from benchbench.run.choices import FAMILIES, choices

ROOT = Path(__file__).resolve().parents[1]


def test_the_page_says_what_the_ledger_says() -> None:
    text = (ROOT / "docs" / "paper_claims.md").read_text("utf-8")
    assert markdown(load()) in text, "python benchmarks/claims.py writes it"
    assert text.count("\n| claim |") == 1


def test_every_command_can_be_typed_and_every_page_is_there() -> None:
    """Programs exist, and so does everything that overrides choose."""
    for one in load():
        assert not one.page or (ROOT / "docs" / one.page).is_file()
        for command in one.commands:
            python, program, *words = shlex.split(command)
            assert python == "python"
            if program != "-m":
                assert (ROOT / program).is_file(), command
                continue
            assert words.pop(0) == "benchbench"
            for family, _, names in (word.lstrip("+").partition("=") for word in words):
                if family in (*FAMILIES, *FLOWN):
                    assert {*names.split(",")} <= {*choices(family)}, command


@pytest.mark.parametrize(
    ("text", "says"),
    [("- source: V\n", "is missing"), ("a: [", "cannot be read"), ("- {source: V, claim: c, commands: [x], value: v, verdict: yes}\n", "verdict")],
)  # fmt: skip
def test_a_broken_ledger_is_told(text: str, says: str, tmp_path: Path) -> None:
    (tmp_path / "l.yaml").write_text(text)
    with pytest.raises(BadInput, match=says):
        load(tmp_path / "l.yaml")
