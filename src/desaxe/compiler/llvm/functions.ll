; Functions that the operations of a Program call, all inlined, and the copies of a block's points.

declare double @llvm.fabs.f64(double)
declare double @llvm.sqrt.f64(double)
declare double @llvm.floor.f64(double)
declare double @llvm.copysign.f64(double, double)
declare double @llvm.fma.f64(double, double, double)
declare double @llvm.fmuladd.f64(double, double, double)
declare i64 @llvm.smin.i64(i64, i64)
declare double @sin(double)
declare double @cos(double)
declare double @atan2(double, double)
declare double @exp(double)
declare double @log(double)
declare double @pow(double, double)

; ---- copies ------------------------------------------------------------------------------------------

; n doubles at steps of some bytes, side by side: where they are, or copied.
define internal ptr @gathered(ptr %buffer, ptr %from, i64 %step, i64 %n) noinline {
  %straight = icmp eq i64 %step, 8
  br i1 %straight, label %there, label %loop
there:
  ret ptr %from
loop:
  %i = phi i64 [ 0, %0 ], [ %next, %loop ]
  %bytes = mul i64 %i, %step
  %at = getelementptr i8, ptr %from, i64 %bytes
  %value = load double, ptr %at
  %to = getelementptr double, ptr %buffer, i64 %i
  store double %value, ptr %to
  %next = add nuw nsw i64 %i, 1
  %more = icmp ult i64 %next, %n
  br i1 %more, label %loop, label %end
end:
  ret ptr %buffer
}

; Some doubles, of which n are copied and the others are the last of these.
define internal void @fill(ptr noalias %buffer, ptr noalias %from, i64 %n, i64 %all) noinline {
  %last = add i64 %n, -1
  br label %loop
loop:
  %i = phi i64 [ 0, %0 ], [ %next, %loop ]
  %index = call i64 @llvm.smin.i64(i64 %i, i64 %last)
  %at = getelementptr double, ptr %from, i64 %index
  %value = load double, ptr %at
  %to = getelementptr double, ptr %buffer, i64 %i
  store double %value, ptr %to
  %next = add nuw nsw i64 %i, 1
  %more = icmp ult i64 %next, %all
  br i1 %more, label %loop, label %end
end:
  ret void
}

define internal void @scatter_double(ptr %to, i64 %step, ptr %buffer, i64 %n) noinline {
  %straight = icmp eq ptr %to, %buffer
  br i1 %straight, label %end, label %loop
loop:
  %i = phi i64 [ 0, %0 ], [ %next, %loop ]
  %from = getelementptr double, ptr %buffer, i64 %i
  %value = load double, ptr %from
  %bytes = mul i64 %i, %step
  %at = getelementptr i8, ptr %to, i64 %bytes
  store double %value, ptr %at
  %next = add nuw nsw i64 %i, 1
  %more = icmp ult i64 %next, %n
  br i1 %more, label %loop, label %end
end:
  ret void
}

define internal void @scatter_i8(ptr %to, i64 %step, ptr %buffer, i64 %n) noinline {
  %straight = icmp eq ptr %to, %buffer
  br i1 %straight, label %end, label %loop
loop:
  %i = phi i64 [ 0, %0 ], [ %next, %loop ]
  %from = getelementptr i8, ptr %buffer, i64 %i
  %value = load i8, ptr %from
  %bytes = mul i64 %i, %step
  %at = getelementptr i8, ptr %to, i64 %bytes
  store i8 %value, ptr %at
  %next = add nuw nsw i64 %i, 1
  %more = icmp ult i64 %next, %n
  br i1 %more, label %loop, label %end
end:
  ret void
}

; The indices of the flagged of n points; the last is repeated up to a multiple of eight, whose number is told.
define internal i64 @indices(ptr noalias %flags, i64 %n, ptr noalias %indices) noinline {
  br label %loop
loop:
  %i = phi i64 [ 0, %0 ], [ %next, %loop ]
  %count = phi i64 [ 0, %0 ], [ %counted, %loop ]
  %to = getelementptr i64, ptr %indices, i64 %count
  store i64 %i, ptr %to
  %at = getelementptr i8, ptr %flags, i64 %i
  %flag = load i8, ptr %at
  %one = zext i8 %flag to i64
  %counted = add i64 %count, %one
  %next = add nuw nsw i64 %i, 1
  %more = icmp ult i64 %next, %n
  br i1 %more, label %loop, label %last
last:
  %end = add i64 %counted, -1
  %end_at = getelementptr i64, ptr %indices, i64 %end
  %index = load i64, ptr %end_at
  %up = add i64 %counted, 7
  %filled = and i64 %up, -8
  br label %fill
fill:
  %k = phi i64 [ %counted, %last ], [ %after, %body ]
  %some = icmp ult i64 %k, %filled
  br i1 %some, label %body, label %done
body:
  %fill_at = getelementptr i64, ptr %indices, i64 %k
  store i64 %index, ptr %fill_at
  %after = add i64 %k, 1
  br label %fill
done:
  ret i64 %filled
}

define internal void @compress(ptr noalias %to, ptr noalias %from, ptr noalias %indices, i64 %n) noinline {
  br label %loop
loop:
  %i = phi i64 [ 0, %0 ], [ %next, %loop ]
  %at = getelementptr i64, ptr %indices, i64 %i
  %index = load i64, ptr %at
  %source = getelementptr double, ptr %from, i64 %index
  %value = load double, ptr %source
  %target = getelementptr double, ptr %to, i64 %i
  store double %value, ptr %target
  %next = add nuw nsw i64 %i, 1
  %more = icmp ult i64 %next, %n
  br i1 %more, label %loop, label %end
end:
  ret void
}

define internal void @expand_double(ptr noalias %to, ptr noalias %from, ptr noalias %indices, i64 %n) noinline {
  br label %loop
loop:
  %i = phi i64 [ 0, %0 ], [ %next, %loop ]
  %at = getelementptr i64, ptr %indices, i64 %i
  %index = load i64, ptr %at
  %source = getelementptr double, ptr %from, i64 %i
  %value = load double, ptr %source
  %target = getelementptr double, ptr %to, i64 %index
  store double %value, ptr %target
  %next = add nuw nsw i64 %i, 1
  %more = icmp ult i64 %next, %n
  br i1 %more, label %loop, label %end
end:
  ret void
}

define internal void @expand_i8(ptr noalias %to, ptr noalias %from, ptr noalias %indices, i64 %n) noinline {
  br label %loop
loop:
  %i = phi i64 [ 0, %0 ], [ %next, %loop ]
  %at = getelementptr i64, ptr %indices, i64 %i
  %index = load i64, ptr %at
  %source = getelementptr i8, ptr %from, i64 %i
  %value = load i8, ptr %source
  %target = getelementptr i8, ptr %to, i64 %index
  store i8 %value, ptr %target
  %next = add nuw nsw i64 %i, 1
  %more = icmp ult i64 %next, %n
  br i1 %more, label %loop, label %end
end:
  ret void
}

; Call a repair of the points that are left over, and clear the flags that a NaN raises: it is an answer.
define internal void @finish(i64 %left, ptr %repair, ptr %clear, ptr %args, ptr %lengths, ptr %steps) noinline {
  %some = icmp ne i64 %left, 0
  %can = icmp ne ptr %repair, null
  %do = and i1 %some, %can
  br i1 %do, label %call, label %flags
call:
  call void %repair(ptr %args, ptr %lengths, ptr %steps)
  br label %flags
flags:
  %raised = icmp ne ptr %clear, null
  br i1 %raised, label %lower, label %end
lower:
  %ignored = call i32 %clear(i32 61)
  br label %end
end:
  ret void
}
