"""Feasibility: can a design be assembled, can it turn.

feasibility  one design in plain Python, many in NumPy
"""
