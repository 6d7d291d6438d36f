"""Kinds of number that several sections share, each with its limits."""

from __future__ import annotations

from typing import Annotated

from surefoot.config.typed_toml import Within

Share = Annotated[float, Within(0.0, 1.0)]

Friction = Annotated[float, Within(0.05, 2.0)]
"""Coefficient of the ground that a controller counts on; without any no foot could hold a robot."""

FrictionSpeed = Annotated[float, Within(1e-3, 10.0)]
"""Joint speed over which Coulomb friction turns round [rad/s]; it is divided by."""

LeastForce = Annotated[float, Within(0.0, 100.0)]
MostForce = Annotated[float, Within(10.0, 5000.0)]
"""Normal force that a stance foot is to have at least, and at most [N]."""

Weight = Annotated[float, Within(0.0, 1e6)]

InputWeight = Annotated[float, Within(1e-6, 1e6)]
"""A weight that cannot be left out: an input that costs nothing has no optimum."""

ConeRounding = Annotated[float, Within(1e-3, 1e4)]
"""Regularisation of a friction cone's tip [N^2]; the bare tip has no slope."""
