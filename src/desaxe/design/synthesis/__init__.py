"""Designs with a required stroke, time ratio and peak.

synthesize  the public call
family      the designs of one stroke and time ratio
peak        the members of a family with a required largest acceleration
"""
