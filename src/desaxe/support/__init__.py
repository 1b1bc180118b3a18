"""The ground floor: general helpers, open to every room, independent of the mechanism.

extras         a missing optional dependency as one line that says what to install
files          files written whole or not at all; locks across processes
written        the mark of outputs, by which desaxe knows what it may replace; generated texts
roots          one root of a function
panels         functions as polynomials on panels: integrals, roots, extremes
progress       how far long work is, and a bar on the terminal
version        the version of this installation
lazy           NumPy, imported when it is first used
forks          locks and threads that a forked process must not inherit
signals        what handlers of signals raise, put off until a block is done
interrupts     long compiled work, which an interrupt or a time limit stops
memory         a check for free memory
checks         options of calls, checked
deadline       a time limit
text_table     tables as text, in even columns
answer         results: dicts with a readable repr
computed       properties that are computed once
recent         a cache of the most recently used values
shown          a value in a message, shortened; a number with its unit
template       text files of the package, with places for values
toml           untrusted TOML files, read with limits on size and depth
"""
