"""The ground floor: general helpers, open to every room, independent of the mechanism.

extras         a missing optional dependency as one line that says what to install
files          files written beside their place and swapped in
locks          a lock across processes
roots          one root of a function
progress       how far long work is, and a bar on the terminal
quantity_text  a number with its unit as text
version        the version of this installation
"""
