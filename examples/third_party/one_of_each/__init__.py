"""Plugins for BenchBench from another package: one of each family, each one file and one line of pyproject.toml."""
