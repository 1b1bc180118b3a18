; Operations that take LLVM several instructions: a line each, the last one is the value.
;
; {f}, {b} and {i} are the types of doubles, conditions and whole numbers, of vectors or single, {s} the end of
; the names of intrinsics; a constant double stands as its bits, a whole number as {wholeN}.

; two_sum_error (Knuth)
sum = fadd {f} {0}, {1}
of_b = fsub {f} {sum}, {0}
of_a = fsub {f} {sum}, {of_b}
lost_a = fsub {f} {0}, {of_a}
lost_b = fsub {f} {1}, {of_b}
fadd {f} {lost_a}, {lost_b}

; two_product_error
product = fmul {f} {0}, {1}
negative = fneg {f} {product}
call {f} @llvm.fma.{s}({f} {0}, {f} {1}, {f} {negative})

; rounding
size = call {f} @llvm.fabs.{s}({f} {0})
fmul {f} {0x3CC0000000000000}, {size}

; power_of_two (Rump)
large = fcmp olt {f} {0}, {0x7BF0000000000000}
below = select {b} {large}, {f} {0}, {f} {0x7BF0000000000000}
small = fcmp ogt {f} {below}, {0x03F0000000000000}
size = select {b} {small}, {f} {below}, {f} {0x03F0000000000000}
wide = fmul {f} {0x4340000000000000}, {size}
sum = fadd {f} {wide}, {size}
step = fsub {f} {sum}, {wide}
some = fcmp ogt {f} {step}, {0x0000000000000000}
select {b} {some}, {f} {step}, {f} {size}

; hypot
x = call {f} @llvm.fabs.{s}({f} {0})
y = call {f} @llvm.fabs.{s}({f} {1})
less = fcmp olt {f} {x}, {y}
most = select {b} {less}, {f} {y}, {f} {x}
least = select {b} {less}, {f} {x}, {f} {y}
ratio = fdiv {f} {least}, {most}
square = fmul {f} {ratio}, {ratio}
sum = fadd {f} {0x3FF0000000000000}, {square}
root = call {f} @llvm.sqrt.{s}({f} {sum})
product = fmul {f} {most}, {root}
both = fadd {f} {most}, {least}
some = fcmp ogt {f} {least}, {0x0000000000000000}
size = select {b} {some}, {f} {product}, {f} {both}
nothing = fsub {f} {most}, {most}
infinite = fcmp une {f} {nothing}, {0x0000000000000000}
select {b} {infinite}, {f} {both}, {f} {size}

; rotated_sin: beyond 2^52 the last bits of a double are those of the whole number added to it
shifted = fadd {f} {2}, {0x4338000000000000}
turns = bitcast {f} {shifted} to {i}
odd = trunc {i} {turns} to {b}
value = select {b} {odd}, {f} {1}, {f} {0}
bits = bitcast {f} {value} to {i}
next = add {i} {turns}, {whole0}
half = lshr {i} {next}, {whole1}
sign = shl {i} {half}, {whole63}
signed = xor {i} {bits}, {sign}
bitcast {i} {signed} to {f}

; rotated_cos
shifted = fadd {f} {2}, {0x4338000000000000}
turns = bitcast {f} {shifted} to {i}
odd = trunc {i} {turns} to {b}
value = select {b} {odd}, {f} {0}, {f} {1}
bits = bitcast {f} {value} to {i}
next = add {i} {turns}, {whole1}
half = lshr {i} {next}, {whole1}
sign = shl {i} {half}, {whole63}
signed = xor {i} {bits}, {sign}
bitcast {i} {signed} to {f}
