"""What can go wrong on the bus."""


class BusError(RuntimeError):
    """A fault of the bus; says the topic or endpoint, what was found and what would be right."""


class MessageError(BusError):
    """A message that is not what its topic promises: wrong type, shape, or a value that is not finite."""


class RecordingError(BusError):
    """A recording that cannot be read or written; says which file, what is wrong and what can be done."""
