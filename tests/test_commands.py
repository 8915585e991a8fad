"""Commands explain themselves, are found when misspelt, and are completed by shells."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from program import assert_refused, told
from test_at_once import HEAVY

from benchbench.cli import commands


def test_the_help_names_every_command_with_what_it_does(tmp_path: Path) -> None:
    said = told(tmp_path, "--help").stdout
    assert max(map(len, said.splitlines())) <= 80
    lines = [line.split() for line in said.splitlines()]
    for usage, text in commands.summaries().items():
        words = f"{usage.removeprefix('benchbench ')} {text}".split()
        assert words in [line[: len(words)] for line in lines], usage


@pytest.mark.parametrize("command", commands.names())
def test_a_command_explains_itself_with_examples(tmp_path: Path, command: str) -> None:
    done = told(tmp_path, command, "--help")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith(f"usage: benchbench {command}")
    _, _, examples = done.stdout.partition("\nexamples\n")
    assert f"benchbench {command}" in examples
    assert told(tmp_path, command, "-h").stdout == done.stdout


def test_no_help_waits_for_the_program_behind_it(tmp_path: Path) -> None:
    asks = "import sys; from benchbench.cli import at_once, commands\n"
    asks += "for name in commands.names(): at_once.answer([name, '--help'])\n"
    asks += "print(*{name.partition('.')[0] for name in sys.modules}, file=sys.stderr)"
    done = subprocess.run(
        [sys.executable, "-c", asks], capture_output=True, text=True, check=True, cwd=tmp_path
    )
    assert not HEAVY & {*done.stderr.split()}


def test_a_misspelt_command_is_told_the_nearest(tmp_path: Path) -> None:
    assert_refused(told(tmp_path, "reprot"), "reprot", "perhaps 'report' is meant")
    assert_refused(told(tmp_path, "circle"), "circle", "perhaps '+scenario=circle' is meant")
    assert_refused(
        told(tmp_path, "xyzzy"), "xyzzy", "there is no such command; allowed: best, bundle, certify"
    )


TYPED = {
    "benchbench exp": ["export"],
    "benchbench +sc": ["+scenario="],
    "benchbench +scenario=two": ["+scenario=two_free"],
    "benchbench +scenario=circle solver=ip": ["solver=ipopt"],
    "benchbench +scenario=circle rep": [],  # a command comes first
    "benchbench --ver": ["--version"],
    "benchbench runs --remove-": ["--remove-orphans"],
    "benchbench suite hand": ["handover100"],
    "benchbench plugins dynamics=lie": ["dynamics=lie_verlet"],
    "benchbench tune space.yaml relax": ["relaxation="],
    "benchbench completion ": ["bash", "fish", "zsh"],
}
"""What is offered at the end of a line."""
ASKS = """
import os, sys
from benchbench.cli.completion import complete
for line in sys.argv[1:]:
    if not os.fork():
        os.environ |= {"COMP_LINE": line, "COMP_POINT": str(len(line)), "COMP_TYPE": "9", "_ARGCOMPLETE": "1",
                       "_ARGCOMPLETE_SHELL": "fish", "_ARGCOMPLETE_IFS": " ", "_ARGCOMPLETE_SUPPRESS_SPACE": "1"}
        complete(output_stream=sys.stdout)  # never returns
    os.wait()
    print(flush=True)
"""
"""All lines in one process that is none of ours: argcomplete speaks through descriptors 8 and 9, and exits."""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_shells_are_offered_commands_options_and_choices(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", ASKS, *TYPED], capture_output=True, text=True, check=True, cwd=tmp_path
    )
    said = [sorted({*line.split()} - {"-h", "--help"}) for line in done.stdout.splitlines()]
    assert dict(zip(TYPED, said, strict=True)) == TYPED, done.stderr


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_script_is_one_of_that_shell(tmp_path: Path, shell: str) -> None:
    done = told(tmp_path, "completion", shell)
    assert done.returncode == 0 and "benchbench" in done.stdout and "_ARGCOMPLETE" in done.stdout
    if found := shutil.which(shell):
        subprocess.run([found, "-n"], input=done.stdout, text=True, check=True)


def test_bash_completes(tmp_path: Path) -> None:
    """The script in a real shell, which asks the real program; words are broken at the equals sign there."""
    bash, benchbench = shutil.which("bash"), Path(sys.executable).with_name("benchbench")
    if bash is None or not benchbench.is_file():
        pytest.skip("there is no bash, or benchbench is on the path, but not installed")
    line = "benchbench +scenario=circle solver=ipo"
    asks = f"""eval "$(benchbench completion bash)"
COMP_LINE='{line}' COMP_POINT={len(line)}; COMP_WORDBREAKS=$' \\t\\n=:'; _python_argcomplete benchbench 2>/dev/null
echo "${{COMPREPLY[@]}}" """
    path = f"{benchbench.parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run([bash, "-c", asks], env={**os.environ, "PATH": path}, capture_output=True, text=True,
                          cwd=tmp_path, check=False)  # fmt: skip
    assert done.stdout.split() == ["ipopt"], done.stderr
