"""The damped rigid body under springs: equations of motion, integrators, simulations."""
