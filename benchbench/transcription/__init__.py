"""From continuous time to blocks of an MPCC."""
