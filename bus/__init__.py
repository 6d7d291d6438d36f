"""What the processes say to each other: messages, the topic table, the codec and the ways to carry them."""
