/* fuzz_model_open.c: any bytes as a model are refused or harmless in use. Length and checksum are repaired first, so
 * that the fuzzer gets past them. Runs as a regression test in tests/unit/test_fuzz.c. As a fuzzer:
 *   clang -g -O1 -std=c11 -ffp-contract=off -fsanitize=fuzzer,address,undefined -DSMR_LIBFUZZER -Isrc -Iinclude \
 *     -Ifixtures -Itests tests/fuzz/fuzz_model_open.c tests/unit/unit_mesh.c tests/unit/unit_exercise.c \
 *     tests/property/rig.c tests/unit/oracle.c fixtures/fixture_bone.c fixtures/fixture_net.c \
 *     fixtures/fixture_shape.c \
 *     fixtures/fixture_deform.c $(find src -name '*.c') -lm -o fuzz_model_open
 * Seeds: run the program test_fuzz with SMR_FUZZ_CORPUS=dir.
 * SPDX-License-Identifier: MIT */
#include "fuzz/fuzz_targets.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "unit/unit_exercise.h"

int fuzz_model_open(const uint8_t *data, size_t size)
{
    static smr_surface *target; /* made once, kept */
    if (target == NULL) {
        unit_mesh ball = unit_sphere(1, 5.0f, 2.0f);
        target = unit_surface(&ball);
        unit_mesh_free(&ball);
    }
    if (size > 1u << 20)
        return 0;
    unsigned char *image = rig_rough(size);
    if (size > 0u)
        memcpy(image, data, size);
    unit_repair(image, size);
    const smr_model *model = NULL;
    int opened = 0;
    if (smr_model_open(image, size, &model) == SMR_OK) {
        const char *wrong = unit_exercise(model, target, 18, 1);
        opened = 1;
        if (wrong != NULL) {
            (void)fprintf(stderr, "fuzz_model_open: %s\n", wrong);
            opened = -1;
        }
    }
    rig_free(image);
    return opened;
}

SMR_FUZZER(fuzz_model_open)
