"""The processes of the stack and what they share. Imports `bus` and `config`; only `io` imports `hw`."""
