"""Reports: everything that was computed of a scene as sections of texts, tables and pictures.

blocks     sections, texts, tables, pictures; numbers as cells
render     blocks as text for a terminal, as a page of HTML, as Markdown
page       a whole document: which sections, in which order; warnings, versions, its command; its file
design     inputs and loads, the mechanism and its geometry, its drive, what tolerances do
curves     the outputs over the crank angle, and the pictures of the scene
"""
