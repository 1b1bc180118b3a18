"""The requests of a scene: read from its tables, what they take, and their answers as sections of a report.

grid         the plan of its grid, run block by block, or swept into its store
checks       printed values beside the computed ones
peaks        peaks over designs, and the claims about them
peak_answer  their values, angles and slopes as a section
motor        [steady]: steady states on a motor
turning      which designs turn fully
pictures     families of curves as files
"""
