"""What flights need beside BenchBench itself, asked for before anything is computed."""

from __future__ import annotations

from importlib.util import find_spec

from benchbench.ground.errors import Unavailable


def need(module: str, by: str) -> None:
    """Raise Unavailable where a module of the extra `flight` is not installed; by: what asks for it."""
    if find_spec(module) is None:
        raise Unavailable(f"{by}: {module} is not installed; pip install 'benchbench[flight]'")
