; Tables that operations of a Program look up: at one point, and at LANES points.

; The number of the piece at x: where the knots are even, the first guess is right; else a binary search.
define internal double @lookup_piece.f64(double %x, ptr %knots, ptr %rows, i64 %n, double %way) noinline {
  %last = add i64 %n, -1
  %end = getelementptr double, ptr %knots, i64 %last
  %first = load double, ptr %knots
  %stop = load double, ptr %end
  %pieces = uitofp i64 %last to double
  %length = fsub double %stop, %first
  %scale = fdiv double %pieces, %length
  %away = fsub double %x, %first
  %ratio = fmul double %away, %scale
  %positive = fcmp ogt double %ratio, 0.0
  %from = select i1 %positive, double %ratio, double 0.0
  %most = fsub double %pieces, 1.0
  %inside = fcmp olt double %from, %most
  %guess = select i1 %inside, double %from, double %most
  %index = fptoui double %guess to i64
  %left = getelementptr double, ptr %knots, i64 %index
  %next = add i64 %index, 1
  %right = getelementptr double, ptr %knots, i64 %next
  %low = load double, ptr %left
  %high = load double, ptr %right
  %above = fcmp ole double %low, %x
  %below = fcmp olt double %x, %high
  %right_guess = and i1 %above, %below
  br i1 %right_guess, label %end_search, label %search
search:
  %a = phi i64 [ 0, %0 ], [ %a_next, %halve ]
  %b = phi i64 [ %n, %0 ], [ %b_next, %halve ]
  %more = icmp ult i64 %a, %b
  br i1 %more, label %halve, label %end_search
halve:
  %sum = add i64 %a, %b
  %middle = lshr i64 %sum, 1
  %at = getelementptr double, ptr %knots, i64 %middle
  %knot = load double, ptr %at
  %passed = fcmp ole double %knot, %x
  %past = add i64 %middle, 1
  %a_next = select i1 %passed, i64 %past, i64 %a
  %b_next = select i1 %passed, i64 %b, i64 %middle
  br label %search
end_search:
  %place = phi i64 [ %next, %0 ], [ %a, %search ]
  %back = add i64 %n, 1
  %returns = fcmp olt double %way, 0.0
  %offset = select i1 %returns, i64 %back, i64 0
  %piece = add i64 %place, %offset
  %number = uitofp i64 %piece to double
  ret double %number
}

define internal double @from_knot.f64(double %x, ptr %knots, i64 %n, i64 %number) noinline {
  %back = add i64 %n, 1
  %returns = icmp uge i64 %number, %back
  %there = sub i64 %number, %back
  %piece = select i1 %returns, i64 %there, i64 %number
  %some = icmp ugt i64 %piece, 0
  %before = sub i64 %piece, 1
  %index = select i1 %some, i64 %before, i64 0
  %at = getelementptr double, ptr %knots, i64 %index
  %knot = load double, ptr %at
  %s = fsub double %x, %knot
  ret double %s
}

define internal double @lookup.f64(double %x, ptr %knots, ptr %rows, i64 %n, double %piece) noinline {
  %number = fptoui double %piece to i64
  %s = call double @from_knot.f64(double %x, ptr %knots, i64 %n, i64 %number)
  %row = getelementptr [4 x double], ptr %rows, i64 %number
  %b_at = getelementptr double, ptr %row, i64 1
  %c_at = getelementptr double, ptr %row, i64 2
  %d_at = getelementptr double, ptr %row, i64 3
  %a = load double, ptr %row
  %b = load double, ptr %b_at
  %c = load double, ptr %c_at
  %d = load double, ptr %d_at
  %sd = fmul double %s, %d
  %c_sd = fadd double %c, %sd
  %s_c = fmul double %s, %c_sd
  %b_c = fadd double %b, %s_c
  %s_b = fmul double %s, %b_c
  %value = fadd double %a, %s_b
  ret double %value
}

define internal double @lookup_slope.f64(double %x, ptr %knots, ptr %rows, i64 %n, double %piece) noinline {
  %number = fptoui double %piece to i64
  %s = call double @from_knot.f64(double %x, ptr %knots, i64 %n, i64 %number)
  %row = getelementptr [4 x double], ptr %rows, i64 %number
  %b_at = getelementptr double, ptr %row, i64 1
  %c_at = getelementptr double, ptr %row, i64 2
  %d_at = getelementptr double, ptr %row, i64 3
  %b = load double, ptr %b_at
  %c = load double, ptr %c_at
  %d = load double, ptr %d_at
  %d3 = fmul double 3.0, %d
  %sd = fmul double %s, %d3
  %c2 = fmul double 2.0, %c
  %c_sd = fadd double %c2, %sd
  %s_c = fmul double %s, %c_sd
  %slope = fadd double %b, %s_c
  ret double %slope
}

; A few knots are counted; of many a first guess may be right at all points, else all are searched together.
define internal <LANES x double> @lookup_piece.vLANESf64(<LANES x double> %x, ptr %knots, ptr %rows, i64 %n, <LANES x double> %way) noinline {
  %few = icmp ule i64 %n, 16
  br i1 %few, label %count, label %guess
count:
  %k = phi i64 [ 0, %0 ], [ %k_next, %count ]
  %before = phi <LANES x double> [ zeroinitializer, %0 ], [ %counted, %count ]
  %knot_at = getelementptr double, ptr %knots, i64 %k
  %knot = load double, ptr %knot_at
  %knot_first = insertelement <LANES x double> poison, double %knot, i64 0
  %knot_all = shufflevector <LANES x double> %knot_first, <LANES x double> poison, <LANES x i32> zeroinitializer
  %behind = fcmp ole <LANES x double> %knot_all, %x
  %one_more = fadd <LANES x double> %before, splat (double 1.0)
  %counted = select <LANES x i1> %behind, <LANES x double> %one_more, <LANES x double> %before
  %k_next = add i64 %k, 1
  %k_more = icmp ult i64 %k_next, %n
  br i1 %k_more, label %count, label %end_search
guess:
  %last = add i64 %n, -1
  %end = getelementptr double, ptr %knots, i64 %last
  %first = load double, ptr %knots
  %stop = load double, ptr %end
  %pieces = uitofp i64 %last to double
  %length = fsub double %stop, %first
  %scale = fdiv double %pieces, %length
  %limit = fsub double %pieces, 1.0
  %first_one = insertelement <LANES x double> poison, double %first, i64 0
  %first_all = shufflevector <LANES x double> %first_one, <LANES x double> poison, <LANES x i32> zeroinitializer
  %scale_one = insertelement <LANES x double> poison, double %scale, i64 0
  %scale_all = shufflevector <LANES x double> %scale_one, <LANES x double> poison, <LANES x i32> zeroinitializer
  %limit_one = insertelement <LANES x double> poison, double %limit, i64 0
  %limit_all = shufflevector <LANES x double> %limit_one, <LANES x double> poison, <LANES x i32> zeroinitializer
  %away = fsub <LANES x double> %x, %first_all
  %ratio = fmul <LANES x double> %away, %scale_all
  %positive = fcmp ogt <LANES x double> %ratio, zeroinitializer
  %from = select <LANES x i1> %positive, <LANES x double> %ratio, <LANES x double> zeroinitializer
  %inside = fcmp olt <LANES x double> %from, %limit_all
  %guessed = select <LANES x i1> %inside, <LANES x double> %from, <LANES x double> %limit_all
  %index = fptoui <LANES x double> %guessed to <LANES x i64>
  %next = add <LANES x i64> %index, splat (i64 1)
  %low = call <LANES x double> @elements(ptr %knots, <LANES x i64> %index)
  %high = call <LANES x double> @elements(ptr %knots, <LANES x i64> %next)
  %above = fcmp ole <LANES x double> %low, %x
  %below = fcmp olt <LANES x double> %x, %high
  %right = and <LANES x i1> %above, %below
  %bits = bitcast <LANES x i1> %right to iLANES
  %all_right = icmp eq iLANES %bits, -1
  br i1 %all_right, label %guessed_right, label %search
guessed_right:
  %place_guessed = uitofp <LANES x i64> %next to <LANES x double>
  br label %end_search
search:
  %size = phi i64 [ %n, %guess ], [ %rest, %search ]
  %base = phi <LANES x i64> [ zeroinitializer, %guess ], [ %base_next, %search ]
  %up = add i64 %size, 1
  %half = lshr i64 %up, 1
  %half_one = insertelement <LANES x i64> poison, i64 %half, i64 0
  %half_all = shufflevector <LANES x i64> %half_one, <LANES x i64> poison, <LANES x i32> zeroinitializer
  %past = add <LANES x i64> %base, %half_all
  %probe = add <LANES x i64> %past, splat (i64 -1)
  %there = call <LANES x double> @elements(ptr %knots, <LANES x i64> %probe)
  %passed = fcmp ole <LANES x double> %there, %x
  %base_next = select <LANES x i1> %passed, <LANES x i64> %past, <LANES x i64> %base
  %rest = sub i64 %size, %half
  %more = icmp ugt i64 %rest, 0
  br i1 %more, label %search, label %searched
searched:
  %place_searched = uitofp <LANES x i64> %base_next to <LANES x double>
  br label %end_search
end_search:
  %place = phi <LANES x double> [ %counted, %count ], [ %place_guessed, %guessed_right ], [ %place_searched, %searched ]
  %back = add i64 %n, 1
  %back_one = uitofp i64 %back to double
  %back_first = insertelement <LANES x double> poison, double %back_one, i64 0
  %back_all = shufflevector <LANES x double> %back_first, <LANES x double> poison, <LANES x i32> zeroinitializer
  %inward = fadd <LANES x double> %place, %back_all
  %returns = fcmp olt <LANES x double> %way, zeroinitializer
  %piece = select <LANES x i1> %returns, <LANES x double> %inward, <LANES x double> %place
  ret <LANES x double> %piece
}

define internal <LANES x double> @from_knot.vLANESf64(<LANES x double> %x, ptr %knots, i64 %n, <LANES x i64> %number) noinline {
  %back = add i64 %n, 1
  %back_one = insertelement <LANES x i64> poison, i64 %back, i64 0
  %back_all = shufflevector <LANES x i64> %back_one, <LANES x i64> poison, <LANES x i32> zeroinitializer
  %returns = icmp uge <LANES x i64> %number, %back_all
  %there = sub <LANES x i64> %number, %back_all
  %piece = select <LANES x i1> %returns, <LANES x i64> %there, <LANES x i64> %number
  %some = icmp ugt <LANES x i64> %piece, zeroinitializer
  %before = sub <LANES x i64> %piece, splat (i64 1)
  %index = select <LANES x i1> %some, <LANES x i64> %before, <LANES x i64> zeroinitializer
  %knot = call <LANES x double> @elements(ptr %knots, <LANES x i64> %index)
  %s = fsub <LANES x double> %x, %knot
  ret <LANES x double> %s
}

define internal <LANES x double> @lookup.vLANESf64(<LANES x double> %x, ptr %knots, ptr %rows, i64 %n, <LANES x double> %piece) noinline {
  %number = fptoui <LANES x double> %piece to <LANES x i64>
  %s = call <LANES x double> @from_knot.vLANESf64(<LANES x double> %x, ptr %knots, i64 %n, <LANES x i64> %number)
  %row = call { <LANES x double>, <LANES x double>, <LANES x double>, <LANES x double> } @coefficients(ptr %rows, <LANES x i64> %number)
  %a = extractvalue { <LANES x double>, <LANES x double>, <LANES x double>, <LANES x double> } %row, 0
  %b = extractvalue { <LANES x double>, <LANES x double>, <LANES x double>, <LANES x double> } %row, 1
  %c = extractvalue { <LANES x double>, <LANES x double>, <LANES x double>, <LANES x double> } %row, 2
  %d = extractvalue { <LANES x double>, <LANES x double>, <LANES x double>, <LANES x double> } %row, 3
  %sd = fmul <LANES x double> %s, %d
  %c_sd = fadd <LANES x double> %c, %sd
  %s_c = fmul <LANES x double> %s, %c_sd
  %b_c = fadd <LANES x double> %b, %s_c
  %s_b = fmul <LANES x double> %s, %b_c
  %value = fadd <LANES x double> %a, %s_b
  ret <LANES x double> %value
}

define internal <LANES x double> @lookup_slope.vLANESf64(<LANES x double> %x, ptr %knots, ptr %rows, i64 %n, <LANES x double> %piece) noinline {
  %number = fptoui <LANES x double> %piece to <LANES x i64>
  %s = call <LANES x double> @from_knot.vLANESf64(<LANES x double> %x, ptr %knots, i64 %n, <LANES x i64> %number)
  %row = call { <LANES x double>, <LANES x double>, <LANES x double>, <LANES x double> } @coefficients(ptr %rows, <LANES x i64> %number)
  %b = extractvalue { <LANES x double>, <LANES x double>, <LANES x double>, <LANES x double> } %row, 1
  %c = extractvalue { <LANES x double>, <LANES x double>, <LANES x double>, <LANES x double> } %row, 2
  %d = extractvalue { <LANES x double>, <LANES x double>, <LANES x double>, <LANES x double> } %row, 3
  %d3 = fmul <LANES x double> splat (double 3.0), %d
  %sd = fmul <LANES x double> %s, %d3
  %c2 = fmul <LANES x double> splat (double 2.0), %c
  %c_sd = fadd <LANES x double> %c2, %sd
  %s_c = fmul <LANES x double> %s, %c_sd
  %slope = fadd <LANES x double> %b, %s_c
  ret <LANES x double> %slope
}
