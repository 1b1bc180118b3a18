"""Scenes: a mechanism, its motion and the requested quantities, as data.

scene        `desaxe.scene`: Scene and SceneResult
schema       the keys of a scene file, their types and what they mean
json_schema  the schema for editors
values       numbers with units, lists and ranges as SI numbers
spread       evenly spaced values of a range, each rounded once
printed      values as a paper prints them, compared digit by digit
content      what a scene says, checked and in SI units
read         a file or mapping as Content
needs        the inputs that quantities need
requested    [[check]], [[peak]] and [[picture]] as what they ask for
places       what a run needs and where it writes, looked at before it computes
run          Content -> values, peaks, checks, then files
command      `desaxe run`
grid         the plan of its grid, run block by block
peaks        peaks over designs
motor        [steady]: steady states on a motor
turning      which designs turn fully
pictures     families of curves as files
stored       a scene as a sweep into its store
sweep        `desaxe.sweep`
kernel       the kernel of a scene's grid
files        NetCDF, Zarr, CSV, xlsx, npz
quiet_store  a folder of zarr in which the first error ends the writing
tables       a labelled result as rows, units in the headings
workbook     sheets of an .xlsx file
report       the result as text
document/    the result as a page to hand on, HTML or Markdown
explain/     what a scene will do before it does it
export/      a scene as a module of its own
explorer/    a scene as a page for the browser
loads        loads of a scene: tables and files
units        `[units]`: units attached to plain numbers
"""
