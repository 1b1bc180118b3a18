"""Reading of scenes: a file or mapping as `Content`, numbers with their units.

read       a file or mapping as Content
peaks      [[peak]] as a request
values     numbers with units, lists and ranges as SI numbers
spread     evenly spaced values of a range, each rounded once
printed    values as a paper prints them, compared digit by digit
loads      loads of a scene: tables and files
needs      the inputs that quantities need
written    what a scene has in writing: its inputs, and the units of its texts
"""
