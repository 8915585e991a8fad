"""Built-in relaxations."""
