"""The best design within limits.

optimize  the public call: one objective, or the Pareto front of several
problem   objectives, space and limits, read and checked; values and gradients
search    scan, SLSQP, the last digits, and a search without derivatives
optimum   the result: multipliers, active limits, message
"""
