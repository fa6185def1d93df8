"""All equilibria: critical rotations of the objective, found by independent methods."""
