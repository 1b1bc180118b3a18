"""The best design within limits.

optimize       the public call
objectives     objectives, free parameters and limits, read and checked
problem        values and gradients in variables from 0 to 1
kinks          measures with a kink as the largest or smallest of smooth ones
search         scan, SLSQP, refinement by the optimality conditions
one_objective  the optimum of one objective
pareto         the front of several objectives
optimum        what was found: multipliers, active limits, message
"""
