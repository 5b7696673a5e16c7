/* carry_result.c: opens the map of a result, and carries points by it.
 * SPDX-License-Identifier: MIT */
#include "carry/carry_result.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

int host_carried_open(host_carried *c, const char *directory, uint32_t threads, host_error *error)
{
    size_t bytes = 0;
    memset(c, 0, sizeof *c);
    if (host_port_open(&c->port, threads, error) != 0 || host_carry_read(directory, &c->shape, &c->path, error) != 0)
        return -1;
    if (smr_carry_bytes(c->shape.n_vertices, 0, c->port.port.n_workers, &bytes) == SMR_OK)
        c->memory = host_alloc(bytes);
    if (c->memory == NULL || smr_carry_fit(c->shape.rest, c->shape.n_vertices, NULL, 0, &c->port.port, c->memory, bytes,
                                           &c->carry) != SMR_OK)
        return host_fail(error, "start", "free memory");
    return 0;
}

void host_carried_close(host_carried *c)
{
    host_carry_free(&c->shape);
    free(c->path);
    free(c->memory);
    host_port_close(&c->port);
}

static void mirror(const host_carried *c, float *xyz, uint32_t n)
{
    uint32_t i = 0;
    for (i = 0; i < n && c->shape.mirror != HOST_MIRROR_NONE; i++)
        xyz[3u * (size_t)i + (size_t)c->shape.mirror] = 0.0f - xyz[3u * (size_t)i + (size_t)c->shape.mirror];
}

int64_t host_carried_points(host_carried *c, uint32_t inverse, float *xyz, uint32_t n, unsigned char *missed,
                            host_error *error)
{
    smr_carry_fact *const facts = malloc((n + 1u) * sizeof *facts);
    smr_status status = SMR_OK;
    int64_t bad = 0;
    uint32_t i = 0;
    if (facts == NULL)
        return host_fail(error, "carry", "free memory");
    if (!inverse)
        mirror(c, xyz, n);
    status = smr_carry_map(c->carry, c->shape.now, inverse, xyz, n, xyz, facts);
    if (inverse && status == SMR_OK)
        mirror(c, xyz, n);
    for (i = 0; i < n && status == SMR_OK; i++) {
        const int lost = !(facts[i].miss_mm <= HOST_CARRY_MISS);
        bad += lost;
        if (missed != NULL)
            missed[i] = (unsigned char)lost;
    }
    free(facts);
    return status == SMR_OK ? bad
                            : host_fail(error, "carry", "points within +-%.0f mm (%s)", (double)SMR_COORD_MAX,
                                        smr_status_name(status));
}

void host_carried_box(const host_carried *c, uint32_t inverse, float low[3], float high[3])
{
    const float *const xyz = inverse ? c->shape.now : c->shape.rest;
    size_t i = 0;
    for (i = 0; i < 3u * (size_t)c->shape.n_vertices; i++) {
        const size_t k = i % 3u;
        const float v = !inverse && (int)k == c->shape.mirror ? 0.0f - xyz[i] : xyz[i];
        low[k] = i < 3u || v < low[k] ? v : low[k];
        high[k] = i < 3u || v > high[k] ? v : high[k];
    }
}
