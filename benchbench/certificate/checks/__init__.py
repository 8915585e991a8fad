"""The questions of the certificate, each a small function from the evidence to checks."""
