"""Configuration that BenchBench finds through the entry point group `benchbench.conf`."""
