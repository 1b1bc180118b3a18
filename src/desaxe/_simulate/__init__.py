"""`simulate`: the motion of the crank under a torque, for one design or for many at once."""

from .call import simulate

__all__ = ["simulate"]
