"""The fault drill: each process killed, paused and restarted in each phase of a live run, and what comes of it."""
