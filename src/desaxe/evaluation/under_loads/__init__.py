"""Values under loads that vary with the motion.

loaded   values under loads that vary with the motion
request  names under loads by one kernel, whose arguments are tables
columns  loads at a few points: their values there, then the Program, then total derivatives
quality  condition numbers and error bounds under loads that are tables
arcs     arcs of crank angles on which one piece of a load holds
sides    on which side of a jump of a load samples are
"""
