"""SymPy lives here and nowhere else: loop closure -> rates -> sensitivities -> one frozen Program.

loop         the mechanism: its vectors, solved by SymPy, and the partial derivatives of the rod
stable       the variables in which nothing cancels, and recollection in them
motion       how the crank moves: paper A's law, or a given state
sheet        the equation sheet: named equations and the chain rule between them
quantities   every quantity, its unit, its meaning and where the papers have it
freeze       the sheet as a Program
build        all of the above, in order, with a report
write        what is written to generated/, and the check that it is fresh
equation     one quantity as a SymPy expression and LaTeX
rod          the rod's functions, followed along the crank
geometry     partial derivatives of phi and Y of any order
folded       derivatives of Y where crank and rod fold back onto each other
start        derivatives with respect to alpha near theta = 0
dynamics     forces, torque and energies, in lumped masses
bodies       the three free bodies, solved by SymPy: the proof of `dynamics`
polynomials  polynomials for sine and cosine, pi/2 in parts
groups       the outputs of each committed kernel
stable_text  the stable form of a quantity for a reader
textbook     the closed forms as plain functions
report       `python -m derive --report`
"""
