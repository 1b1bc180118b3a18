"""The steady state of a machine on its motor.

steady    `desaxe.steady`: all periodic motions of a machine, the stable one at the highest speed first
source    a torque of any kind over angle and speed
designs   designs in rows, and the equation of motion over the crank angle
scan      turns from many speeds, and the changes of sign of what a turn gains
orbit     periodic motions by Newton's method, on panels between kinks
figures   period, speeds, work and power, and their derivatives with respect to every number
states    from designs to all of their steady states, and to the flywheel for a wanted fluctuation
result    the dict that `steady` returns; why there is no steady state
"""
