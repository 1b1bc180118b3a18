"""The energy form in plain loops, which are compiled.

instants   where motions are at instants, in plain loops
pieces     a piece of a motion between two kinks or standstills
follow     one motion in plain loops: energy and time as integrals over panels
turns      whole turns without an instant, many at once, in plain loops
through    derivatives of time and energy through whole panels and many turns, in plain loops
partly     the same on other pieces, such as those next to a standstill
varied     its derivatives by parameters in plain loops
compiled   the same, compiled
"""
