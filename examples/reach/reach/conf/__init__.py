"""Its scenarios."""
