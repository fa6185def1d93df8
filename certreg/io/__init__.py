"""Files of clouds, weights and poses: strict readers, atomic writers. The package loads nothing."""
