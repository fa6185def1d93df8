"""The paper's experiments, figures and claims with verdicts, for the command line alone."""
