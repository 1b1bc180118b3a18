"""The best design within limits.

optimize       the public call
objectives     objectives, free parameters and limits, read and checked
problem        values and gradients in variables from 0 to 1
search         scan, SLSQP, refinement by the optimality conditions
one_objective  the optimum of one objective, and the Pareto front of several
optimum        what was found: multipliers, active limits, message
"""
