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

/* The entry of libFuzzer, in a file that is compiled alone with SMR_LIBFUZZER; with SMR_FUZZ_FILES a program that runs
 * files. */
#if defined(SMR_FUZZ_FILES)
#include <stdio.h>
#define SMR_FUZZER(target)                                                                                             \
    int main(int argc, char **argv)                                                                                    \
    {                                                                                                                  \
        static uint8_t bytes[1u << 16];                                                                                \
        for (int i = 1; i < argc; i++) {                                                                               \
            FILE *const file = fopen(argv[i], "rb");                                                                   \
            if (file == NULL || target(bytes, fread(bytes, 1, sizeof bytes, file)) < 0 || fclose(file) != 0) {         \
                (void)fprintf(stderr, "%s\n", argv[i]);                                                                \
                return 1;                                                                                              \
            }                                                                                                          \
        }                                                                                                              \
        return 0;                                                                                                      \
    }
#elif defined(SMR_LIBFUZZER)
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
