"""Has BenchBench become worse? A fixed small matrix against a stored baseline."""
