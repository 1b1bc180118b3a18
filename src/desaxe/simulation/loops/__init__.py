"""Motions in plain loops, which are compiled: pieces, a panel of time, its cut, and again.

march         pieces and signs that hold, and panels of one motion up to its cuts
cuts          the earliest cut of a panel
panels        the next panel, as long as tolerance and cuts allow
newton        Newton's method for the state at its nodes
law           the rates at nodes, from the pieces of loads; where a motion starts
motions       motions of designs one after the other, one call for all
compiled      the machine code of all, and the kernel that it calls
torque        a torque's function, compiled alone
"""
