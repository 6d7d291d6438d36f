"""The optimal control problem of eqs. (1)-(6) that mpc and trajopt both solve."""
