"""The picture of a run in a browser: what messages say, made into shapes; where they come from; viser's page."""
