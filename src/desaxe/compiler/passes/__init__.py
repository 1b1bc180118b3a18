"""The passes: pure functions Program -> Program, one a module.

`pipeline` lists those of every request and reports what each saved; `lowering`, beside this folder, has the
order of all. A pass needs a valid Program (`program.validate`) and gives one. Besides:

pass             needs                         guarantees
bind             -                             fixed inputs are constants, or lines are replaced by given ones
slicing          -                             every line is reached from an output
fold             -                             constants are computed; factors 0 and 1 are gone
value_numbering  -                             the same value has one name
guard            after bind                    a bad element of an array gives NaN and its status
trigonometry     after guard                   sine and cosine are written out, for angles up to a limit
double_double    after guard                   lines are pairs of doubles (expansions, pairs, double_angles)
fuse             last, before two forms        a product and its sum are one instruction
differentiate    -                             the derivatives of the outputs by an input are outputs too
"""
