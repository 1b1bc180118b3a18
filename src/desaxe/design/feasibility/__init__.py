"""Which designs can be assembled and turn.

feasibility  one design, in plain Python
arrays       many designs, in NumPy
"""
