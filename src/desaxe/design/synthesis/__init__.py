"""Designs with a required stroke and time ratio.

synthesize  the public call
family      the designs of one stroke and time ratio
"""
