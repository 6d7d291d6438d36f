"""The operator's side of a running stack: commands, their answers, tuning, and a terminal to drive from."""
