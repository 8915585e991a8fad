"""Built-in contacts."""
