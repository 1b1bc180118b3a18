"""Designs with a required stroke and time ratio.

synthesize  the public call
"""
