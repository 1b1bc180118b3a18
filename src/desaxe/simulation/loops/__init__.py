"""Motions in plain loops, which are compiled: pieces, a panel of time, its cut, and again.

march         pieces and signs that hold, and panels of one motion up to its cuts
cuts          the earliest cut of a panel
panels        the next panel, as long as tolerance and cuts allow
newton        the law at its nodes, and Newton's method
motions       motions of designs one after the other, one call for all
state         their state, where it starts and what becomes of it; the pieces of loads
compiled      the machine code of all, and the kernel that it calls
torque        a torque's function, compiled alone
"""
