"""Built-in peers: external planners that are run where the user has them."""
