"""The claims, one a file: a statement, its proof in checked steps, and what must fail."""
