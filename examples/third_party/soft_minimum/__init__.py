"""A relaxation for BenchBench from another package."""
