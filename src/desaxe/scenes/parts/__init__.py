"""The requests of a scene: read from its tables, what they take, and their results.

grid      the plan of its grid, run block by block, or swept into its store
checks    printed values beside the computed ones
peaks     peaks over designs, and the claims about them
motor     [steady]: steady states on a motor
turning   which designs turn fully
pictures  families of curves as files
"""
