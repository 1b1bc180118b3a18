"""Reports: everything that was computed of a scene as sections of texts, tables and pictures.

blocks     sections, texts, tables, pictures
render     blocks as text for a terminal, as a page of HTML, as Markdown
page       a whole document: which sections, in which order; warnings, versions, its command; its file
results    checks, feasibility, steady states, values, files: on the terminal, too
peaks      extreme values with angle, side and slopes: on the terminal, too
design     inputs and loads, the mechanism and its geometry, its drive, what tolerances do
curves     the outputs over the crank angle, and the pictures of the scene
"""
