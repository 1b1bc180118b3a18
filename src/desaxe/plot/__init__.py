"""Pictures of labelled results (extra `plot`); pyplot and its global state are never touched.

curves      quantities over one input: families of curves, panels, the histories of a motion
polar       a torque or force over the crank angle; the star of a harmonic
design_map  a quantity over two inputs, what is infeasible hatched
tornado     what a change of each input does, by exact sensitivities
mechanism   crank, rod and slider to scale; the same as it turns, beside a quantity's curve
turn        the drive's torque over a turn, and a machine on its motor
load        a load over the crank angle or the slider's position, with its points
picture     what each of them returns: figure, axes, artists; its file
style       axes, labels, units, titles, colours, legends of all of them
dataset     what is drawn: arrays and motions as a Dataset, samples at jumps

Each draws on `ax=`, or on a new Figure, and returns a `Picture(figure, axes, artists)`.
"""

from .curves import curves, motion, panels
from .design_map import design_map
from .load import load
from .mechanism import animate, mechanism
from .picture import Picture, save
from .polar import polar, star
from .tornado import tornado
from .turn import drive, steady

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
