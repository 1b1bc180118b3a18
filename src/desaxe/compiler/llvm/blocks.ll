  @BUFFERS@
  %last = sub i64 %n, @LANES@
  br label %blocks
blocks:
  %at = phi i64 [ 0, %0 ], [ %stop, %done ]
  %fail = phi i1 [ false, %0 ], [ %now, %done ]
  %left = phi i64 [ 0, %0 ], [ %total, %done ]
  %more = icmp slt i64 %at, %n
  br i1 %more, label %block, label %end
block:
  %start = call i64 @llvm.smin.i64(i64 %at, i64 %last)
  %rest = sub i64 %n, %start
  %size = call i64 @llvm.smin.i64(i64 %rest, i64 @BLOCK@)
  %odd = and i64 %size, @ODD@
  %exact = icmp eq i64 %odd, 0
  @ADDRESSES@
  br i1 %fail, label %ahead, label %first
ahead:
  @TESTS@
  %same = icmp eq i64 @FAILED@, %size
  %all_fail = and i1 %same, %exact
  br i1 %all_fail, label %close, label %first
first:
  @PLAIN@
  %none = icmp eq i64 @COUNT@, 0
  br i1 %none, label %done, label %some
some:
  %most = icmp eq i64 @COUNT@, %size
  %every = and i1 %most, %exact
  br i1 %every, label %close, label %mixed
close:
  @STABLE@
  br label %done
mixed:
  %filled = call i64 @indices(ptr %flags, i64 %size, ptr %indices)
  @GATHERED@
  br label %done
done:
  %own = phi i64 [ 0, %first ], [ @IN_CLOSE@, %close ], [ @IN_MIXED@, %mixed ]
  %now = phi i1 [ false, %first ], [ true, %close ], [ false, %mixed ]
  %total = add i64 %left, %own
  %stop = add i64 %at, @BLOCK@
  br label %blocks
end:
  ret i64 %left
