/* unit_mesh.c: meshes and models for tests.
 * SPDX-License-Identifier: MIT */
#include "unit_mesh.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "fixture_bone.h"

static void give_up(const char *why)
{
    (void)fprintf(stderr, "unit_mesh: %s\n", why);
    abort();
}

unit_mesh unit_mesh_new(uint32_t nv, uint32_t nt)
{
    unit_mesh m = {rig_rough(3u * (size_t)nv * sizeof(float)), NULL, nv, nt};
    if (nt > 0u)
        m.triangles = rig_rough(3u * (size_t)nt * sizeof(uint32_t));
    return m;
}

void unit_mesh_free(unit_mesh *m)
{
    rig_free(m->xyz);
    rig_free(m->triangles);
    memset(m, 0, sizeof *m);
}

smr_mesh unit_view(const unit_mesh *m)
{
    const smr_mesh v = {m->xyz, m->triangles, m->nv, m->nt};
    return v;
}

unit_mesh unit_points(oracle_random *r, uint32_t n, float at, float size)
{
    unit_mesh m = unit_mesh_new(n, 0);
    for (uint32_t i = 0; i < n; i++) {
        for (uint32_t c = 0; c < 3u; c++)
            m.xyz[3u * (size_t)i + c] = at + oracle_uniformf(r, 0.0f, size);
        if (i % 7u == 6u)
            memcpy(m.xyz + 3u * (size_t)i, m.xyz + 3u * (size_t)oracle_below(r, i), 3u * sizeof(float));
    }
    return m;
}

unit_mesh unit_soup(oracle_random *r, uint32_t nt, float size, int shared)
{
    const uint32_t nv = shared ? nt / 2u + 3u : 3u * nt;
    unit_mesh m = unit_mesh_new(nv, nt);
    for (uint32_t i = 0; i < nv; i++)
        for (uint32_t c = 0; c < 3u; c++)
            m.xyz[3u * (size_t)i + c] = oracle_uniformf(r, 0.0f, size);
    for (uint32_t k = 0; k < nt; k++) {
        uint32_t *t = m.triangles + 3u * (size_t)k;
        for (uint32_t c = 0; c < 3u; c++)
            t[c] = shared ? oracle_below(r, nv) : 3u * k + c;
        if (!shared)
            for (uint32_t c = 3; c < 9u; c++) /* small triangles */
                m.xyz[9u * (size_t)k + c] = m.xyz[9u * (size_t)k + c % 3u] + oracle_uniformf(r, -0.05f, 0.05f) * size;
        if (k % 5u == 4u && k % 2u == 0u)
            t[2] = t[1]; /* names a vertex twice */
        else if (k % 5u == 4u && !shared)
            for (uint32_t c = 0; c < 3u; c++) /* three points on a line */
                m.xyz[9u * (size_t)k + 6u + c] = 2.0f * m.xyz[9u * (size_t)k + 3u + c] - m.xyz[9u * (size_t)k + c];
        if (k % 7u == 6u)
            memcpy(t, m.triangles + 3u * (size_t)oracle_below(r, k), 3u * sizeof *t);
    }
    return m;
}

unit_mesh unit_grid(uint32_t nx, uint32_t ny, float step)
{
    unit_mesh m = unit_mesh_new((nx + 1u) * (ny + 1u), 2u * nx * ny);
    for (uint32_t y = 0; y <= ny; y++) {
        for (uint32_t x = 0; x <= nx; x++) {
            float *p = m.xyz + 3u * (size_t)(y * (nx + 1u) + x);
            p[0] = (float)x * step;
            p[1] = (float)y * step;
            p[2] = step * (float)sin(0.7 * (double)x + 0.4 * (double)y);
        }
    }
    uint32_t *t = m.triangles;
    for (uint32_t y = 0; y < ny; y++) {
        for (uint32_t x = 0; x < nx; x++, t += 6) {
            const uint32_t a = y * (nx + 1u) + x, b = a + 1u, c = a + nx + 1u, d = c + 1u;
            const uint32_t two[6] = {a, b, d, a, d, c};
            memcpy(t, two, sizeof two);
        }
    }
    return m;
}

/* The vertex between a and b: found among those made so far, or made. */
static uint32_t middle(unit_mesh *m, uint32_t from, uint32_t a, uint32_t b)
{
    float p[3];
    for (uint32_t c = 0; c < 3u; c++)
        p[c] = 0.5f * (m->xyz[3u * (size_t)a + c] + m->xyz[3u * (size_t)b + c]);
    for (uint32_t v = from; v < m->nv; v++)
        if (memcmp(m->xyz + 3u * (size_t)v, p, sizeof p) == 0)
            return v;
    memcpy(m->xyz + 3u * (size_t)m->nv, p, sizeof p);
    return m->nv++;
}

unit_mesh unit_sphere(uint32_t levels, float radius, float centre)
{
    static const float corner[18] = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
    static const uint32_t face[24] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    const uint32_t most = 8u << (2u * levels);
    unit_mesh m = unit_mesh_new(most / 2u + 2u, most);
    memcpy(m.xyz, corner, sizeof corner);
    memcpy(m.triangles, face, sizeof face);
    m.nv = 6;
    m.nt = 8;
    for (uint32_t level = 0; level < levels; level++) {
        const uint32_t old = m.nt, from = m.nv;
        for (uint32_t k = 0; k < old; k++) {
            uint32_t *t = m.triangles + 3u * (size_t)k, *more = m.triangles + 3u * (size_t)m.nt;
            const uint32_t a = t[0], b = t[1], c = t[2];
            const uint32_t ab = middle(&m, from, a, b), bc = middle(&m, from, b, c), ca = middle(&m, from, c, a);
            const uint32_t four[12] = {ab, bc, ca, a, ab, ca, b, bc, ab, c, ca, bc};
            memcpy(t, four, 3u * sizeof *t);
            memcpy(more, four + 3, 9u * sizeof *t);
            m.nt += 3u;
        }
    }
    for (uint32_t v = 0; v < m.nv; v++) {
        float *p = m.xyz + 3u * (size_t)v;
        const float l = sqrtf(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        for (uint32_t c = 0; c < 3u; c++)
            p[c] = centre + p[c] * (radius / l);
    }
    return m;
}

unit_mesh unit_bone(int target)
{
    const uint32_t cell = FIXTURE_CELL_SMALL;
    unit_mesh m = unit_mesh_new(FIXTURE_VERTICES(cell), FIXTURE_TRIANGLES(cell));
    const size_t words = FIXTURE_SCRATCH_WORDS(cell);
    float *scratch = rig_rough(words * sizeof *scratch);
    fixture_mesh f = {m.xyz, m.triangles, m.nv, m.nt, 0, 0};
    const fixture_grid grid = target ? fixture_grid_target(cell) : fixture_grid_source(cell);
    if (!fixture_bone_source(&grid, &f, scratch, words))
        give_up("the fixture does not fit");
    rig_free(scratch);
    m.nv = f.n_vertices;
    m.nt = f.n_triangles;
    return m;
}

smr_surface *unit_surface(const unit_mesh *m)
{
    const smr_mesh view = unit_view(m);
    size_t bytes = 0;
    if (smr_surface_bytes(m->nv, m->nt, &bytes) != SMR_OK)
        give_up("smr_surface_bytes");
    void *memory = rig_rough(bytes);
    smr_surface *s = NULL;
    if (smr_surface_build(&view, memory, bytes, &s) != SMR_OK || (void *)s != memory)
        give_up("smr_surface_build");
    return s;
}

smr_status unit_align(const smr_surface *model, const smr_surface *target, const smr_align_config *config,
                      smr_pose *pose, smr_align_report *report)
{
    size_t bytes = 0;
    if (smr_align_bytes(config, &bytes) != SMR_OK)
        return SMR_E_CONFIG;
    void *memory = rig_rough(bytes);
    const smr_status status = smr_align(model, target, config, memory, bytes, pose, report);
    rig_free(memory);
    return status;
}

unit_image unit_prepare(const smr_structure *structures, uint32_t n, const smr_prepare_config *config)
{
    unit_image image = {NULL, 0, NULL};
    size_t scratch_bytes = 0;
    if (smr_prepare_bytes(structures, n, config, &scratch_bytes) != SMR_OK)
        give_up("smr_prepare_bytes");
    void *scratch = rig_rough(scratch_bytes);
    if (smr_prepare(structures, n, config, scratch, scratch_bytes, NULL, 0, &image.size) != SMR_OK)
        give_up("smr_prepare without an image");
    image.bytes = rig_rough(image.size);
    if (smr_prepare(structures, n, config, scratch, scratch_bytes, image.bytes, image.size, &image.size) != SMR_OK)
        give_up("smr_prepare");
    rig_free(scratch);
    if (smr_model_open(image.bytes, image.size, &image.model) != SMR_OK)
        give_up("smr_model_open");
    return image;
}

unit_image unit_prepare_mesh(const unit_mesh *m, const smr_prepare_config *config)
{
    smr_structure one = {"mesh", unit_view(m)};
    return unit_prepare(&one, 1, config);
}

void unit_image_free(unit_image *image)
{
    rig_free(image->bytes);
    memset(image, 0, sizeof *image);
}

int unit_finite(const float *v, size_t n, float limit)
{
    for (size_t i = 0; i < n; i++)
        if (!(v[i] >= -limit && v[i] <= limit))
            return 0;
    return 1;
}
