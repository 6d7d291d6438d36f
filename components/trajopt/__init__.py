"""The trajectory optimisation of a stride: what the ground must bear (Sec. II-B)."""
