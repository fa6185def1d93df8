"""Measurements of speed and accuracy, with the bounds that are claimed: `python -m benchmarks`.

A claim about speed is a ratio of two things done in turn in one run, each at its fastest; seconds
stand beside it.
"""
