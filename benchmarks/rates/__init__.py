"""Large samples that take minutes, one module each; `make rates` lists them."""
