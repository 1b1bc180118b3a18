"""Feasibility: can a design be assembled, can it turn.

feasibility  one design, in plain Python
arrays       many designs, in NumPy
"""
