"""From expressions to C: SymPy expressions -> CasADi functions -> C, header, serialised text."""
