"""The damped body under springs: equations of motion, integrators, simulations."""
