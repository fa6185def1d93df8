"""Equilibria of the registration dynamics: closed forms, the complete set, stability."""
