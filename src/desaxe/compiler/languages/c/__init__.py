"""C99: `name.h` and `name.c`, for a controller, a simulation, or any language that calls C.

language   the two files
functions  a Program as a static function, and the calls between them
steps      the motion under a torque, step by step
helpers    what the spellings call: the .c files here
motion/    the C of `steps`
"""

from .language import C

__all__ = ["C"]
