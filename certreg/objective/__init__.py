"""The energy after the best translation, as a function of the rotation."""
