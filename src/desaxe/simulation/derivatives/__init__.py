"""Exact derivatives of an integrated motion by parameters.

sensitivities   derivatives of an integrated motion by parameters
variational     the linear equations that they obey
rubbing_slopes  the derivatives of the torque that friction takes
work            the derivative of the work
slopes          the derivatives of a torque by angle and speed
cuts            by how much sensitivities jump where a motion is cut
collocation     linear equations along a motion, on panels of time
"""
