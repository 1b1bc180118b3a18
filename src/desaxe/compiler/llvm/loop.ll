define internal i64 @@NAME@(@PARAMETERS@) noinline @WIDE@ {
  %last = sub i64 %n, @LANES@
  @SPREAD@
  br label %loop
loop:
  %at = phi i64 [ 0, %0 ], [ %after, %loop ]
  %count = phi i64 [ 0, %0 ], [ @TOTAL@, %loop ]
  %i = call i64 @llvm.smin.i64(i64 %at, i64 %last)
  @POINTS@
  %after = add nuw nsw i64 %at, @LANES@
  %again = icmp ult i64 %after, %n
  br i1 %again, label %loop, label %end
end:
  ret i64 @TOTAL@
}
