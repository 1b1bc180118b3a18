"""`compile`: a scene as source code of its own, in one of several languages.

compile       `desaxe.compile`: a scene to files
command       `desaxe compile`
portable      a scene as the `Module` that every language writes
shaft         a crankshaft as such a `Module`: sums over its sliders
numba_module  what a numba module has besides: axes, reductions, peaks
peaks         the scene's peaks in it
axes          the scene's lists and ranges in it
functions     functions behind these, which go along as they stand
peak_steps    those that numba compiles
solvers       crank angles for a slider position, limit angles
fmu           a Functional Mock-up Unit
motion        the crank's acceleration under a torque
loaded        loads that vary with the motion: their tables
package       `desaxe derive --quantities`: a package of a user's own quantities
"""
