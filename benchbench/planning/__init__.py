"""What is done with several solves to get one plan."""
