"""A recording as tables of NumPy arrays, one a topic: what plots, reports and exports are made from."""
