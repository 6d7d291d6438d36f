"""The safety gate: the last look at every command before the motors. Only `io` uses it, by `Gate`."""
