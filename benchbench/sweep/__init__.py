"""Many runs: each in a worker process of its own, none of which can end the others."""
