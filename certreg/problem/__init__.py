"""A registration problem: points, weights, and the sums over them."""
