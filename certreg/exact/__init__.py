"""Integer and ball arithmetic that decides."""
