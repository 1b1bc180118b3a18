"""Values under loads that vary with the motion.

loaded   values under loads that vary with the motion
kernel   loads in a kernel: its request, its tables, points that rounding leaves open
request  the request of names under loads, and their tables
points   names under loads at the points of large arrays, by one kernel
quality  condition numbers and error bounds under loads that are tables
arcs     arcs of crank angles on which one piece of a load holds
sides    on which side of a jump of a load samples are
"""
