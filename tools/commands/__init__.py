"""One file a subcommand of `surefoot`: its arguments and what it does; slow imports wait until it is called."""
