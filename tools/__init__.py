"""What people run: evaluation, plots and the command line. Imports everything; nobody imports it."""
