"""Built-in payloads."""
