"""BenchBench: certified benchmarks of time-optimal trajectory planning with complementarity constraints (MPCC).

`import benchbench as bb`; what `bb` offers stands in `__init__.pyi` and is loaded when it is first used.
"""

from importlib.metadata import PackageNotFoundError, version

import lazy_loader

try:
    __version__ = version("benchbench")
except PackageNotFoundError:  # run from a source tree that is not installed
    __version__ = "0+unknown"

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
