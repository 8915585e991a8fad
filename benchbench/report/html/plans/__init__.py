"""A plan in the report: the vehicle in space with a time slider, beside everything that is limited."""
