"""Guaranteed ranges over a box of inputs.

enclose  branch and bound over the box
balls    a Program in ball arithmetic
"""
