"""Reference values from the raw loop closure and the free bodies, to any number of digits.

Imports nothing else of desaxe.

jet          Taylor polynomials in ball arithmetic
truth        kinematics
force_truth  forces, torques, energies
families     seeded points where formulas lose their digits
"""
