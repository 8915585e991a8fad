"""Statistics of many runs, as pure functions: rates with intervals, profiles, means, who ran what."""
