"""Built-in models of the residual acceleration."""
