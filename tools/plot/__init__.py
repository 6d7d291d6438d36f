"""Pictures of a recording: one small file for each thing that is drawn, all in `catalogue`."""
