"""An MPCC relaxed, assembled and solved."""
