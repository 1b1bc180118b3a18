"""Values under loads that vary with the motion.

request  names under loads as one request, whose arguments are tables
loaded   values under loads, and labelled arrays as loads
arcs     arcs of crank angles on which one piece of a load holds
"""
