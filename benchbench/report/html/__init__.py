"""The report: all runs of some folders as one HTML file that needs no network."""
