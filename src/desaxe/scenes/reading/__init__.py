"""Reading of scenes: a file or mapping as `Content`, numbers with their units.

read       a file or mapping as Content
values     numbers with units, lists and ranges as SI numbers; what quantities need
spread     evenly spaced values of a range, each rounded once
"""
