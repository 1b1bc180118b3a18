"""A scene as a Functional Mock-up Unit of FMI 2.0: model exchange and co-simulation from one C source.

write        the archive: description, source, binary
variables    the table of variables; a value reference is a place in it
programs     the Programs of acceleration, outputs, their partial derivatives and loads
source       the C source
description  modelDescription.xml
model.c      the model: loads held between kinks, start, events, partial derivatives, co-simulation
fmi2.c       the functions of the standard
"""
