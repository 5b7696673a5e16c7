/* test_gzip_write.c: what gzip_write packs, inflate unpacks; runs become small.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <stdlib.h>
#include <string.h>
#include "files/gzip_write.h"
#include "volumes/volume_reader.h"

TEST(packs_and_unpacks)
{
    enum { MOST = 100000 };
    unsigned char *const data = malloc(MOST), *const back = malloc(MOST);
    uint32_t seed = 7, i = 0, kind = 0;
    assert_non_null(data);
    assert_non_null(back);
    for (kind = 0; kind < 4u; kind++)
        for (size_t n = 0; n <= MOST; n = n < 6 ? n + 1 : 7 * n + 3) {
            host_buffer packed;
            memset(&packed, 0, sizeof packed);
            for (i = 0; i < n; i++) {
                seed = seed * 1664525u + 1013904223u;
                data[i] = (unsigned char)(kind == 0   ? 0
                                          : kind == 1 ? seed >> 24
                                          : kind == 2 ? i / 300u
                                                      : i % 40000u % 251u);
            }
            host_gzip_write(data, n, &packed);
            assert_int_equal(packed.failed, 0);
            assert_null(host_inflate(packed.data, packed.size, back, n));
            assert_memory_equal(data, back, n);
            if (kind == 0 && n > 10000)
                assert_true(packed.size < n / 50u);
            host_buffer_free(&packed);
        }
    free(data);
    free(back);
}
