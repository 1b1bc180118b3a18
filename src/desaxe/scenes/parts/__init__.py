"""The parts of a run, each from Content to labelled results.

grid      the plan of its grid, run block by block
stored    a scene as a sweep into its store
extremes  peaks over designs, and the claims about them
motor     [steady]: steady states on a motor
turning   which designs turn fully
pictures  families of curves as files
"""
