"""Built-in plugins; the core never imports them, a third party's package has the same shape."""
