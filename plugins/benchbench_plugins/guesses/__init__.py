"""Built-in guesses."""
