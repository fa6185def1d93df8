"""The generated code at work: compiled once and cached, or evaluated by CasADi; trajectory loops.

No formula of the dynamics stands here: those are in certreg/native/generated. Handwritten are the loops
around a step, the stop test, and the kick off a saddle.
"""
