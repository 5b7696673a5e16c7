/* test_self_test.c: the self test passes in the mode that the library needs, and names each other mode that a program
 * can set. What compilers do is in tests/check_self_test.sh.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <fenv.h>
#include "smr.h"

TEST(passes) { assert_int_equal(smr_self_test(), 0); }

TEST(finds_rounding)
{
    static const int mode[] = {
#ifdef FE_UPWARD
        FE_UPWARD,
#endif
#ifdef FE_DOWNWARD
        FE_DOWNWARD,
#endif
#ifdef FE_TOWARDZERO
        FE_TOWARDZERO,
#endif
        FE_TONEAREST};
    for (size_t i = 0; i < sizeof mode / sizeof mode[0]; i++) {
        const int set = fesetround(mode[i]);
        const uint32_t found = smr_self_test();
        (void)fesetround(FE_TONEAREST);
        if (set == 0)
            assert_int_equal(found, mode[i] == FE_TONEAREST ? 0u : SMR_FLOAT_ROUNDING);
    }
}

#ifdef __SSE2__
#include <xmmintrin.h>

TEST(finds_flushing)
{
    static const unsigned mode[] = {0x8000u, 0x0040u, 0x8040u}; /* FTZ, DAZ, both */
    const unsigned before = _mm_getcsr();
    for (size_t i = 0; i < sizeof mode / sizeof mode[0]; i++) {
        _mm_setcsr(before | mode[i]);
        const uint32_t found = smr_self_test();
        _mm_setcsr(before);
        assert_int_equal(found, SMR_FLOAT_FLUSHED);
    }
    assert_int_equal(smr_self_test(), 0);
}
#else
static void finds_flushing(void **state)
{
    (void)state;
    skip();
}
#endif

/* Where invalid operations, overflows and divisions by zero trap it must not make any. */
TEST(raises_nothing)
{
    (void)feclearexcept(FE_ALL_EXCEPT);
    assert_int_equal(smr_self_test(), 0);
    assert_int_equal(fetestexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW), 0);
}
