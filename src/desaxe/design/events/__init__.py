"""Dead centres, strokes and extreme angles.

events  the public call, for one design in plain Python and for many in NumPy
"""
