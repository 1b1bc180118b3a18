"""The explorer: one self-contained HTML page on which a design can be looked at and changed.

explore  `desaxe.explore`: a scene or inputs in, a file out
content  what the page knows: inputs, designs, quantities, and the functions that compute them
write    content -> HTML
page/    the page itself: markup, style, and scripts of one idea each
"""
