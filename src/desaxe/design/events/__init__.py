"""Dead centres, strokes and extreme angles.

events       the public call
closed_form  values and derivatives from the closed form; the largest speeds
arrays       many designs, in NumPy
"""
