"""Scenes: a mechanism, its motion and the requested quantities, as data.

scene        `desaxe.scene`: Scene and SceneResult
schema       the keys of a scene file, their types and what they mean
json_schema  the schema for editors
values       numbers with units, lists and ranges as SI numbers
printed      values as a paper prints them, compared digit by digit
content      what a scene says, checked and in SI units
read         a file or mapping as Content
needs        the inputs that quantities need
requested    [[check]], [[peak]] and [[picture]] as what they ask for
run          Content -> grid, checks, files
peaks        peaks over designs
kernel       the kernel of a scene's grid
files        NetCDF, Zarr, CSV, npz
report       the result as text
explain/     what a scene will do before it does it
export/      a scene as a module of its own
explorer/    a scene as a page for the browser
"""
