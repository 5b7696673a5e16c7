/* register_verdict.h: whether a registration's result can be relied on, and why not.
 * SPDX-License-Identifier: MIT */
#ifndef REGISTER_VERDICT_H
#define REGISTER_VERDICT_H

#include <stdint.h>

#include "base/error_line.h"

enum { HOST_VERDICT_GOOD = 0, HOST_VERDICT_LOOK, HOST_VERDICT_FAILED };

#define HOST_REASONS_MAX 24u
#define HOST_REASON_BYTES 240u

typedef struct host_verdict {
    int level;                                        /* HOST_VERDICT_...: the worst of its reasons */
    double expected_error_mm;                         /* NaN: not known */
    uint32_t n_reasons;                               /* further ones are dropped */
    char reason[HOST_REASONS_MAX][HOST_REASON_BYTES]; /* each a sentence that says what to look at */
} host_verdict;

/* "good", "look" or "failed". */
const char *host_verdict_name(int level);

/* Adds a reason of this level. */
void host_verdict_add(host_verdict *verdict, int level, const char *reason, ...) HOST_PRINTF(3, 4);

#endif
