"""One composed configuration, run as the program runs it."""
