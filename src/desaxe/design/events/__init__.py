"""Dead centres, strokes and extreme angles.

events  the public call
found   values and derivatives from the closed form
arrays  many designs, in NumPy
"""
