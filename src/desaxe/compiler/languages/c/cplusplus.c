#if defined(__cplusplus)
#define restrict __restrict
#endif
