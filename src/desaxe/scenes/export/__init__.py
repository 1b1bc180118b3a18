"""`compile`: a scene as source code of its own, in one of several languages.

compile       `desaxe.compile`: a scene to files
command       `desaxe compile`
portable      a scene as the `Module` that every language writes
numba_module  the text of the Python module
solvers       crank angles for a slider position, limit angles
fmu           a Functional Mock-up Unit
motion        the crank's acceleration under a torque
entry_points  the functions that people call in the Python module
peaks         the scene's peaks in the Python module
axes          the scene's lists and ranges
functions     functions behind these, which go along as they stand
texts/        other functions, with places for what depends on the scene
made          its Programs and loop nests, with or without loads
loaded        loads that vary with the motion: their tables
package       `desaxe derive --quantities`: a package of a user's own quantities
"""
