"""The passes: each a pure function Program -> Program in a module of its own.

`bind`       fixes inputs to constants, or puts other lines in place of given ones
`slicing`    keeps only what the wanted outputs reach
`fold`       computes what is constant, drops terms with a factor 0 and factors 1
`number`     gives the same value the same name
`trigonometry`, `double_double`  write sine and cosine out; keep twice the digits
`guard`      gives a bad element of an array NaN and its status
`pipeline`   runs them in order, with a report

`double_double` is made of `expansions` (sums of doubles), `pairs` and `double_angles`.
"""
