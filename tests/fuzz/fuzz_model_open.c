/* fuzz_model_open.c: any bytes as a model are refused or harmless in use. Length and checksum are repaired first, so
 * that the fuzzer gets past them.
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
        const char *wrong = unit_exercise(model, target, 18, UNIT_ALL);
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
