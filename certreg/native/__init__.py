"""The generated code at work: compiled with the package, or run in Python; trajectory loops.

No formula of the dynamics stands here: those are in certreg/native/generated. Handwritten are the
loops around a step, the stop test, and the escape from a saddle.
"""
