"""Certificates: what is proved about a pose, in a file that anyone can check."""
