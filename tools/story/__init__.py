"""The story of a run: one page that says where it went, what it tried, and why it ended."""
