/* fuzz_targets.h: fuzz targets take any bytes. They return 1 when the bytes were accepted, 0 when they were refused,
 * and -1 (with a line on stderr) when something accepted did not work.
 * SPDX-License-Identifier: MIT */
#ifndef FUZZ_TARGETS_H
#define FUZZ_TARGETS_H

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

int fuzz_model_open(const uint8_t *data, size_t size);
int fuzz_mesh(const uint8_t *data, size_t size);
int fuzz_log(const uint8_t *data, size_t size);

/* fuzz_save.c: the kept values of a save. */
int fuzz_save(const uint8_t *data, size_t size);

/* The entry of libFuzzer, in a file that is compiled alone with SMR_LIBFUZZER. */
#ifdef SMR_LIBFUZZER
#define SMR_FUZZER(target)                                                                                             \
    int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);                                                      \
    int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)                                                       \
    {                                                                                                                  \
        if (target(data, size) < 0)                                                                                    \
            abort();                                                                                                   \
        return 0;                                                                                                      \
    }
#else
#define SMR_FUZZER(target)
#endif

#endif
