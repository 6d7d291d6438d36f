"""How feet move between footholds; mpc, trajopt and wbc follow the same curve."""
