"""BenchBench: certified benchmarks of time-optimal trajectory planning with complementarity constraints."""

from importlib.metadata import PackageNotFoundError, version

try:
    __version__ = version("benchbench")
except PackageNotFoundError:  # run from a source tree that is not installed
    __version__ = "0+unknown"
