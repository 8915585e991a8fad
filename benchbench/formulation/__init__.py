"""Task, dynamics and contacts as one MPCC."""
