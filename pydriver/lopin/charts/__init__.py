"""Error against cost of the four methods, as tables and pictures."""
