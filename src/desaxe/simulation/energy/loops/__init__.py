"""The energy form in plain loops whose text numba compiles.

instants   where motions are at instants, in plain loops
at_angles  quantities of many designs at angles, in plain loops
pieces     a piece of a motion between two kinks or standstills
follow     one motion in plain loops: energy and time as integrals over panels
course     speeds, accelerations and energies along motions, in plain loops
turns      whole turns without an instant, many at once, in plain loops
through    derivatives of time and energy through whole panels and many turns, in plain loops
partly     the same on other pieces, such as those next to a standstill
varied     its derivatives by parameters in plain loops
compiled   the same, compiled, for every family of designs
"""
