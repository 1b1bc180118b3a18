"""Reports as documents: one page of HTML or Markdown with everything that was computed of a scene.

parts      what a document is made of: sections of texts, tables, pictures
content    the whole document: which sections, in which order
inputs     inputs, loads, own quantities; the mechanism to scale and its geometry
curves     the quantities asked for over the crank angle, and the pictures of the scene
peaks      extreme values with angle, side and gradient
drive      torque, power and flywheel
motor      the steady state on a motor
spread     what tolerances do
origin     warnings, versions, and the command that made it
html       a document as a page without scripts or anything from elsewhere, for screen and paper
markdown   the same as Markdown
write      the file
"""
