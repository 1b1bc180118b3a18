"""A scene as a Functional Mock-up Unit: FMI 3.0 or 2.0, model exchange and co-simulation from one C source.

write        the archive: description, source, binary
variables    the table of variables; a value reference is a place in it
loads        tables of loads as C arrays
programs     the Programs of acceleration, outputs and their partial derivatives
source       the C source
description  modelDescription.xml
loads.c      loads from tables, held between their kinks; no_loads.c where there are none
model.c      the model: start, events, partial derivatives, DOP853
interface.c  what both versions of the standard share
fmi3.c, fmi2.c   the functions of the standard
"""
