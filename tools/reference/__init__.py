"""Reference pages made from the code: topics, settings, commands. `docs/conf.py` puts them into the site."""
