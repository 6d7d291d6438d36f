"""The state machine of Fig. 6: which leg moves, where to, what it presses, what happens when ground gives way."""
