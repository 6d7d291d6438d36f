"""`surefoot calibrate`: what one robot's sensors and joints are like; estimation is pure functions on arrays."""
