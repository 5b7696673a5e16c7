/* fuzz_mesh.c: any bytes as meshes for smr_surface_build() and smr_prepare() are refused, or give a surface or model
 * that works. Layout of the bytes: 16 of switches, then vertices and triangles of two structures (see take_mesh).
 * SPDX-License-Identifier: MIT */
#include "fuzz/fuzz_targets.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "unit/unit_exercise.h"

typedef struct input {
    const uint8_t *at;
    size_t left;
} input;

static uint32_t take(input *in, uint32_t bytes)
{
    uint32_t v = 0;
    for (uint32_t i = 0; i < bytes && in->left > 0u; i++, in->left--)
        v |= (uint32_t)*in->at++ << 8u * i;
    return v;
}

/* Vertices are 16-bit steps of 1/64 mm, or whole floats of any bits when raw; corners are a byte, within range unless
 * raw. */
static unit_mesh take_mesh(input *in, uint32_t nv, uint32_t nt, int raw)
{
    unit_mesh m = unit_mesh_new(nv, nt);
    for (uint32_t i = 0; i < 3u * nv; i++) {
        const uint32_t bits = take(in, raw ? 4u : 2u);
        if (raw)
            memcpy(m.xyz + i, &bits, sizeof bits);
        else
            m.xyz[i] = (float)(int32_t)(bits ^ 0x8000u) / 64.0f - 512.0f;
    }
    for (uint32_t i = 0; i < 3u * nt; i++)
        m.triangles[i] = raw ? take(in, 1) : take(in, 1) % nv;
    return m;
}

static smr_surface *make_surface(const unit_mesh *m)
{
    const smr_mesh view = unit_view(m);
    size_t bytes = 0;
    const smr_status sized = smr_surface_bytes(m->nv, m->nt, &bytes);
    void *memory = rig_rough(bytes);
    smr_surface *s = NULL;
    if (smr_surface_build(&view, memory, bytes, &s) != SMR_OK || sized != SMR_OK) {
        rig_free(memory);
        return NULL;
    }
    return s;
}

static const char *query(const smr_surface *s, const unit_mesh *m)
{
    static const float normal[3] = {0, 0, 1};
    for (uint32_t v = 0; v < m->nv; v++) {
        smr_closest hit;
        if (smr_surface_closest(s, m->xyz + 3u * (size_t)v, v % 2u ? normal : NULL, -0.5f, 1e6f, &hit) != SMR_OK)
            return "smr_surface_closest";
        if (hit.triangle != SMR_NONE && (hit.triangle >= m->nt || !unit_finite(hit.point, 3, 2e5f) ||
                                         !unit_finite(hit.weight, 3, 1.001f) || !unit_finite(&hit.distance, 1, 1e6f)))
            return "a hit";
    }
    return NULL;
}

static const char *prepare(const smr_structure *s, uint32_t n, const smr_prepare_config *c, const smr_surface *target,
                           uint32_t target_vertices, uint32_t how, int *done)
{
    size_t scratch_bytes = 0, bytes = 0;
    if (smr_prepare_bytes(s, n, c, &scratch_bytes) != SMR_OK)
        return NULL;
    static _Alignas(SMR_ALIGN) unsigned char room[1u << 17];
    void *scratch = rig_rough(scratch_bytes), *image = NULL;
    const smr_model *model = NULL;
    const char *wrong = NULL;
    const int exact = how == UNIT_ALL; /* into memory to the byte, which takes two calls */
    if (smr_prepare(s, n, c, scratch, scratch_bytes, exact ? NULL : room, exact ? 0u : sizeof room, &bytes) == SMR_OK) {
        image = rig_rough(bytes);
        *done = 1;
        if (!exact)
            memcpy(image, room, bytes);
        if (exact && smr_prepare(s, n, c, scratch, scratch_bytes, image, bytes, &bytes) != SMR_OK)
            wrong = "the second smr_prepare";
        else if (smr_model_open(image, bytes, &model) != SMR_OK)
            wrong = "smr_model_open of what smr_prepare wrote";
        else
            wrong = unit_exercise(model, target, target_vertices, how);
    }
    rig_free(scratch);
    rig_free(image);
    return wrong;
}

int fuzz_mesh(const uint8_t *data, size_t size)
{
    input in = {data, size};
    smr_prepare_config c = smr_prepare_config_default();
    const uint32_t switches = take(&in, 4), shape = take(&in, 4);
    c.order = switches & 1u;
    c.distance = switches >> 1 & 1u;
    c.mass = switches >> 2 & 1u;
    c.ring = switches >> 3 & 1u;
    c.block_vertices = switches >> 4 & 1u ? 16u : 0u;
    c.n_radii = switches >> 5 & 3u;
    const uint32_t how = switches >> 12 & 7u; /* most runs are short */
    const int raw = (switches >> 8 & 7u) == 7u;
    c.separate_below_mm = switches >> 7 & 1u ? 0.0f : -1.0f;
    for (uint32_t i = 0; i < 4u; i++)
        c.radius_mm[i] = (float)(take(&in, 2) + 1u) / 16.0f;
    unit_mesh m[2];
    m[0] = take_mesh(&in, 1u + (shape & 31u), shape >> 8 & 31u, raw);
    m[1] = take_mesh(&in, 1u + (shape >> 16 & 15u), shape >> 24 & 15u, 0);
    const smr_structure two[2] = {{"fuzz", unit_view(&m[0])}, {NULL, unit_view(&m[1])}};
    smr_surface *target = make_surface(&m[1]);
    smr_surface *own = make_surface(&m[0]);
    int done = 0;
    const char *wrong = own == NULL ? NULL : query(own, &m[0]);
    if (wrong == NULL)
        wrong = prepare(two, 1u + (switches >> 11 & 1u), &c, target, m[1].nv, how < 3u ? 0u : how & UNIT_ALL, &done);
    rig_free(target);
    rig_free(own);
    unit_mesh_free(&m[0]);
    unit_mesh_free(&m[1]);
    if (wrong != NULL)
        (void)fprintf(stderr, "fuzz_mesh: %s\n", wrong);
    return wrong != NULL ? -1 : done;
}

SMR_FUZZER(fuzz_mesh)
