"""`benchbench completion bash|zsh|fish`: complete words in a shell."""

from __future__ import annotations

from collections.abc import Sequence

from benchbench.cli.arguments import Parser

SHELLS = ("bash", "zsh", "fish")
EXAMPLES = """Commands, their options, choices and their names are completed, from what is installed and the folder of --config-dir.

examples
  eval "$(benchbench completion bash)"        in ~/.bashrc
  eval "$(benchbench completion zsh)"         in ~/.zshrc, after compinit
  benchbench completion fish > ~/.config/fish/completions/benchbench.fish
"""


def run(arguments: Sequence[str]) -> int:
    """Print the script; raises BadInput for another shell."""
    from argcomplete.shell_integration import shellcode

    print(shellcode(["benchbench"], shell=parser().parse_args(arguments).shell))
    return 0


def parser() -> Parser:
    """Return the arguments it takes."""
    takes = Parser(
        "completion", "Print the script that makes a shell complete what is typed after benchbench.", EXAMPLES
    )
    takes.add_argument("shell", choices=SHELLS, help="the shell it is for")
    return takes
