"""The processes of the stack and what several of them share. Imports `bus` and `config`; only `io` imports `hw`."""
