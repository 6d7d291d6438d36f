"""The paper's experiments, run and put beside its figures on one page. Only the command line uses it."""
