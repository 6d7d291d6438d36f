"""What a run leaves behind: journals of its processes, and the MCAP file they are written to and read from."""
