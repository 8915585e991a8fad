def require(*a): pass
