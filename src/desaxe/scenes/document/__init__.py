"""Reports: everything that was computed of a scene as sections of texts, tables and pictures.

blocks     sections, texts, tables, pictures
designs    the designs of a scene, numbers in the units of a report
results    checks, feasibility, steady states, values, files: on the terminal, too
peaks      extreme values with angle, side and slopes: on the terminal, too
content    a whole document: which sections, in which order; warnings, versions, its command
inputs     inputs, loads, user-defined quantities; the mechanism to scale and its geometry
curves     the outputs over the crank angle, and the pictures of the scene
drive      torque, power and flywheel
spread     what tolerances do
terminal   sections as text
html       a document as a page without scripts or anything from elsewhere, for screen and paper
markdown   the same as Markdown
write      the file
"""
