"""Pictures of labelled results (extra `plot`); pyplot and its global state are never touched.

curves      a quantity over one input, one curve for each value of another
panels      several quantities over one input, one above the other
polar       a torque or force over the crank angle
design_map  a quantity over two inputs, what is infeasible hatched
tornado     what a change of each input does, by exact sensitivities
mechanism   crank, rod and slider to scale at a crank angle
drive       drive torque over a turn, and the speed with its flywheel
motion      histories of the motion that a torque causes, with its events
load        a load over the crank angle or the slider's position, with its points
steady      speed and torque of a machine on its motor, and the working loop on its curve
star        what each slider of a crankshaft adds to a harmonic, as arrows
animate     the same as it turns, beside a quantity's curve
save        a figure or animation to a file
picture     what each of them returns: figure, axes, artists
shared      what all of them share: values, labels, colours, legends
titles      the inputs that matter, for a title
jumps       nodes on each side of the jumps of loads
from_dict   a dict of arrays as a Dataset
from_motion a motion as a Dataset

Each draws on `ax=`, or on a new Figure, and returns a `Picture(figure, axes, artists)`.
"""

from .animate import animate as animate
from .curves import curves as curves
from .design_map import design_map as design_map
from .drive import drive as drive
from .load import load as load
from .mechanism import mechanism as mechanism
from .motion import motion as motion
from .panels import panels as panels
from .picture import Picture as Picture
from .polar import polar as polar
from .save import save as save
from .star import star as star
from .steady import steady as steady
from .tornado import tornado as tornado

__all__ = [
    "Picture",
    "animate",
    "curves",
    "design_map",
    "drive",
    "load",
    "mechanism",
    "motion",
    "panels",
    "polar",
    "save",
    "star",
    "steady",
    "tornado",
]
