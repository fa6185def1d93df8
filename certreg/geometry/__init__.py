"""Rotations, poses and the quadratic constraints that make a matrix a rotation."""
