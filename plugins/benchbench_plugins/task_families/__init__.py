"""Built-in families of tasks."""
