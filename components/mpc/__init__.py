"""The model predictive controller: one SQP iteration of the shared problem at every tick."""
