#if defined(__FAST_MATH__)
#error "compile without -ffast-math: it drops error terms and the NaN of an infeasible point"
#endif
#if defined(FLT_EVAL_METHOD) && FLT_EVAL_METHOD != 0
#error "numbers must be evaluated in their own type: -mfpmath=sse, for example"
#endif
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC optimize("fp-contract=off", "no-math-errno", "no-trapping-math")
#elif !defined(_MSC_VER)
#pragma STDC FP_CONTRACT OFF
#endif
