"""Dead centres, strokes and extreme angles.

events       the public call
closed_form  the formulas and their derivatives
arrays       many designs, in NumPy
"""
