"""A deployment as a service of this machine's systemd."""
