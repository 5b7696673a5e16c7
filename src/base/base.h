/* base.h: included by every file: assumptions about float, scalar helpers, parallel loops, cookies of configurations.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_BASE_H
#define SMR_BASE_H

#include <float.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "smr.h"

#ifdef __FAST_MATH__
#error "-ffast-math changes results: compile smr without it, see docs/SPEC.md, section 1"
#endif

/* Bit-exact results need float arithmetic in float; see docs/SPEC.md, "Floating-point environment". Float is
 * evaluated in float under 0 and under 16, which GCC reports for AVX512-FP16 processors unless -std= is strict. */
_Static_assert(FLT_EVAL_METHOD == 0 || FLT_EVAL_METHOD == 16, "float arithmetic must be done in float");
_Static_assert(sizeof(float) == 4 && FLT_MANT_DIG == 24, "float must be IEEE 754 binary32");

#define SMR_SQRT(x) __builtin_sqrtf(x)
#define SMR_SHARED __attribute__((noinline)) /* marks a function with many callers, of which copies would take room */
#define SMR_SELDOM __attribute__((cold))   /* marks a function that runs at most a few times an iteration: less code */
#define SMR_UNUSED __attribute__((unused)) /* marks a parameter that the function type demands but nothing reads */

/* Makes the calling function return the status of `call`, unless it is SMR_OK. */
#define SMR_TRY(call)                                                                                                  \
    do {                                                                                                               \
        const smr_status smr_tried = (call);                                                                           \
        if (smr_tried != SMR_OK)                                                                                       \
            return smr_tried;                                                                                          \
    } while (0)

static inline float smr_max(float a, float b) { return a > b ? a : b; }
static inline float smr_min(float a, float b) { return a < b ? a : b; }
static inline float smr_abs(float a) { return a < 0.0f ? -a : a; }
static inline float smr_clamp(float a, float lo, float hi) { return smr_min(smr_max(a, lo), hi); }
static inline uint32_t smr_min_u32(uint32_t a, uint32_t b) { return a < b ? a : b; }
static inline uint32_t smr_max_u32(uint32_t a, uint32_t b) { return a > b ? a : b; }

/* Returns the smaller of a and b, in a number of instructions that does not depend on the values. */
static inline uint64_t smr_min_u64(uint64_t a, uint64_t b)
{
    const uint64_t mask = 0u - (uint64_t)(a < b);
    return b ^ ((a ^ b) & mask);
}

static inline uint32_t smr_ceil_div(uint32_t a, uint32_t b) { return a / b + (a % b != 0u); }

/* Returns i, or n - 1 when a fault has made the index i of n elements too large. n is at least 1. */
static inline uint32_t smr_index(uint32_t i, uint32_t n) { return i < n ? i : n - 1u; }

/* Returns a when a is positive, otherwise +0. The function has no branch, so compilers vectorise loops that call it. */
static inline float smr_positive(float a)
{
    int32_t bits;
    memcpy(&bits, &a, sizeof bits);
    bits &= ~(bits >> 31);
    memcpy(&a, &bits, sizeof a);
    return a;
}

/* 1: memory that is used soon is prefetched. Microcontrollers hardly wait for memory. */
#if defined(__ARM_ARCH_PROFILE) && __ARM_ARCH_PROFILE == 'M'
#define SMR_PREFETCHES 0
#else
#define SMR_PREFETCHES 1
#endif

/* Returns 1 when |a| <= limit; 0 otherwise, and for NaN and infinities. */
static inline int smr_within(float a, float limit) { return a >= -limit && a <= limit; }

/* Returns 1 when all n values are within +-most; 0 with a NaN among the values. */
static inline int smr_all_within(const float *value, size_t n, float most)
{
    int outside = 0;
    for (size_t i = 0; i < n; i++)
        outside |= !smr_within(value[i], most);
    return !outside;
}

/* Types of the functions that return a stage's number of tasks, and that run a task. stage: struct of step or stage. */
typedef uint32_t smr_count_tasks(const void *stage);
typedef void smr_run_task(void *stage, uint32_t task, uint32_t worker);

/* The items first .. last-1 of an array. */
typedef struct smr_piece {
    uint32_t first, last;
} smr_piece;

/* Returns part k of `parts` about equal parts of n items. */
static inline smr_piece smr_part(uint32_t n, uint32_t k, uint32_t parts)
{
    return (smr_piece){(uint32_t)((uint64_t)n * k / parts), (uint32_t)((uint64_t)n * (k + 1u) / parts)};
}

/* Calls run(arg, t, worker) once for each task t in 0 .. n_tasks-1. Returns 1 when all tasks are done, 0 when the port
 * has not run each task once. Without a parallel port, or with one task, the calling thread runs the tasks in order.
 * n_tasks must follow from the model, never from the number of workers, so that results do not depend on that. */
int smr_fork(const smr_port *port, smr_task run, void *arg, uint32_t n_tasks);

/* Union-find: returns the root of i's set and shortens the path to it. parent[i]: the element above i; i for a root. */
static inline uint32_t smr_set_root(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i)
        i = parent[i] = parent[parent[i]];
    return i;
}

/* The cookie of a configuration: tag, major version and struct size, by which other versions' structs are refused. */
#define SMR_COOKIE(tag, type)                                                                                          \
    (((uint32_t)(tag) << 24) | ((uint32_t)SMR_VERSION_MAJOR << 16) | (uint32_t)(sizeof(type) & 0xffffu))

#endif
