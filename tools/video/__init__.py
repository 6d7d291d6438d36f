"""A recording as a film: what the simulator would have shown, rendered without a display."""
