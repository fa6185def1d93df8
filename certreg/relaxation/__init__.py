"""Semidefinite relaxations, of the rotation problem and of a quartic: what other methods solve.

And the optimum of general springs that they propose, or else the paths to all critical lines; and
poses with many pairs within their bounds, where some pairs are wrong.
"""
