/* answers.c: what the library answers, in bits that are the same on every processor and stay the same: of small
 * registrations onto targets of each kind the positions, the verdict, expected errors and reports, and of the calls
 * beside registrations the results. Prints a line for each: its name and checksums.
 * tests/golden/answers.txt has the lines; `make golden-update` writes the file after a wanted change.
 * Only + - * / and sqrtf make the inputs, as in the fixtures.
 * SPDX-License-Identifier: MIT */
#include "answers.h"
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- memory and checksums */

static void *room[512];
static uint32_t kept, n_rooms; /* rooms for all lines, and for this one, too */

void *answers_room(size_t bytes)
{
    const size_t whole = (bytes + SMR_ALIGN) / SMR_ALIGN * SMR_ALIGN;
    answers_need(n_rooms < sizeof room / sizeof room[0], "rooms");
    void *const at = room[n_rooms++] = aligned_alloc(SMR_ALIGN, whole);
    answers_need(at != NULL, "memory");
    memset(at, 0, whole);
    return at;
}

void answers_keep(void) { kept = n_rooms; }

void answers_need(int holds, const char *what)
{
    if (holds)
        return;
    printf("answers error: %s\n", what);
    exit(1);
}

static uint32_t crc = 0xffffffffu;

void answers_put(const void *words, size_t bytes)
{
    for (size_t i = 0; i < bytes / 4u; i++) {
        uint32_t word;
        memcpy(&word, (const unsigned char *)words + 4u * i, 4);
        crc ^= word;
        for (uint32_t bit = 0; bit < 32u; bit++)
            crc = crc >> 1 ^ (0xedb88320u & (0u - (crc & 1u)));
    }
}

void answers_put_bytes(const void *bytes, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        const uint32_t word = ((const unsigned char *)bytes)[i];
        answers_put(&word, 4);
    }
}

int answers_put_status(smr_status status)
{
    const uint32_t word = (uint32_t)status;
    answers_put(&word, 4);
    return status == SMR_OK;
}

void answers_say(const char *what)
{
    printf(" %s %08x", what, (unsigned)crc);
    crc = 0xffffffffu;
}

void answers_begin(const char *name)
{
    printf("%s:", name);
    crc = 0xffffffffu;
}

void answers_end(void)
{
    printf("\n");
    while (n_rooms > kept)
        free(room[--n_rooms]);
}

/* ---- targets: what is left of a mesh, and moved */

smr_mesh answers_copy(const smr_mesh *mesh)
{
    float *xyz = answers_room(12u * (size_t)mesh->n_vertices);
    uint32_t *t = answers_room(12u * (size_t)mesh->n_triangles);
    memcpy(xyz, mesh->xyz, 12u * (size_t)mesh->n_vertices);
    memcpy(t, mesh->triangles, 12u * (size_t)mesh->n_triangles);
    return (smr_mesh){xyz, t, mesh->n_vertices, mesh->n_triangles};
}

smr_mesh answers_cut(const smr_mesh *mesh, uint32_t axis, float least)
{
    smr_mesh part = answers_copy(mesh);
    uint32_t *const t = (uint32_t *)(uintptr_t)part.triangles;
    part.n_triangles = 0;
    for (uint32_t k = 0; k < mesh->n_triangles; k++)
        if (mesh->xyz[3u * mesh->triangles[3u * k] + axis] > least)
            memcpy(t + 3u * part.n_triangles++, mesh->triangles + 3u * k, 12);
    return part;
}

smr_mesh answers_noisy(const smr_mesh *mesh, float mm)
{
    const smr_mesh copy = answers_copy(mesh);
    for (uint32_t i = 0; i < 3u * copy.n_vertices; i++)
        ((float *)(uintptr_t)copy.xyz)[i] += 0.125f * mm * (float)((int32_t)(i * 2654435761u >> 28) - 8);
    return copy;
}

/* Turned about the z axis by the tangent of half the angle, scaled and shifted; by a negative scale also mirrored. */
smr_mesh answers_moved(const smr_mesh *mesh, float t, float scale, float shift)
{
    const smr_mesh m = answers_copy(mesh);
    const float c = (1.0f - t * t) / (1.0f + t * t), s = 2.0f * t / (1.0f + t * t);
    for (uint32_t v = 0; v < m.n_vertices; v++) {
        float *const p = (float *)(uintptr_t)m.xyz + 3u * v, x = p[0], y = p[1];
        p[0] = scale * (c * x - s * y) + shift;
        p[1] = fabsf(scale) * (s * x + c * y);
        p[2] *= fabsf(scale);
    }
    for (uint32_t k = 0; scale < 0.0f && k < m.n_triangles; k++) {
        uint32_t *const corner = (uint32_t *)(uintptr_t)m.triangles + 3u * k, first = corner[0];
        corner[0] = corner[1];
        corner[1] = first;
    }
    return m;
}

smr_mesh answers_joined(const smr_mesh *a, const smr_mesh *b)
{
    float *const xyz = answers_room(12u * (size_t)(a->n_vertices + b->n_vertices));
    uint32_t *const t = answers_room(12u * (size_t)(a->n_triangles + b->n_triangles));
    memcpy(xyz, a->xyz, 12u * (size_t)a->n_vertices);
    memcpy(xyz + 3u * a->n_vertices, b->xyz, 12u * (size_t)b->n_vertices);
    memcpy(t, a->triangles, 12u * (size_t)a->n_triangles);
    for (uint32_t i = 0; i < 3u * b->n_triangles; i++)
        t[3u * a->n_triangles + i] = b->triangles[i] + a->n_vertices;
    return (smr_mesh){xyz, t, a->n_vertices + b->n_vertices, a->n_triangles + b->n_triangles};
}

smr_surface *answers_surface(const smr_mesh *mesh)
{
    smr_surface *surface = NULL;
    size_t bytes = 0;
    answers_need(smr_surface_bytes(mesh->n_vertices, mesh->n_triangles, &bytes) == SMR_OK, "surface");
    answers_need(smr_surface_build(mesh, answers_room(bytes), bytes, &surface) == SMR_OK, "surface");
    return surface;
}

smr_points *answers_points(const smr_mesh *mesh, int normals, uint32_t strays)
{
    smr_points *points = NULL;
    size_t bytes = 0;
    const uint32_t n = mesh->n_triangles / 2u + strays;
    float *const xyz = answers_room(12u * (size_t)n), *const out = answers_room(12u * (size_t)n);
    for (uint32_t i = 0; i < n; i++) { /* middles of triangles, and strays beside */
        const uint32_t *const t = mesh->triangles + 3u * (2u * i % mesh->n_triangles);
        float e[2][3];
        for (uint32_t c = 0; c < 3u; c++) {
            const float *const p = mesh->xyz + c;
            const float stray = i < n - strays ? 0.0f : 60.0f + (float)(i * 37u % 50u);
            xyz[3u * i + c] = (p[3u * t[0]] + p[3u * t[1]] + p[3u * t[2]]) / 3.0f + stray;
            e[0][c] = p[3u * t[1]] - p[3u * t[0]];
            e[1][c] = p[3u * t[2]] - p[3u * t[0]];
        }
        for (uint32_t c = 0; c < 3u; c++) {
            const uint32_t u = (c + 1u) % 3u, w = (c + 2u) % 3u;
            out[3u * i + c] = e[0][u] * e[1][w] - e[0][w] * e[1][u];
        }
    }
    answers_need(smr_points_bytes(n, &bytes) == SMR_OK, "points");
    answers_need(smr_points_open(n, answers_room(bytes), bytes, &points) == SMR_OK, "points");
    answers_need(smr_points_add(points, xyz, normals ? out : NULL, NULL, n) == SMR_OK, "points");
    return points;
}

/* ---- everything that a registration answers */

static void say_structure(smr *s, uint32_t structure, uint32_t n)
{
    float *const mm = answers_room(12u * (size_t)n), *const along = answers_room(4u * (size_t)n);
    smr_structure_report report;
    smr_structure_volume volume;
    smr_verdict verdict;
    smr_pose pose;
    float residual;
    if (answers_put_status(smr_get_verdict(s, structure, &verdict)))
        answers_put(&verdict, sizeof verdict);
    if (answers_put_status(smr_get_pose(s, structure, &pose, &residual))) {
        answers_put(&pose, sizeof pose);
        answers_put(&residual, sizeof residual);
    }
    if (structure == SMR_ALL)
        return;
    if (answers_put_status(smr_get_expected_error(s, structure, mm)))
        answers_put(mm, 4u * (size_t)n);
    if (answers_put_status(smr_get_expected_parts(s, structure, mm, along))) {
        answers_put(mm, 4u * (size_t)n);
        answers_put(along, 4u * (size_t)n);
    }
    if (answers_put_status(smr_get_structure_report(s, structure, &report)))
        answers_put(&report, sizeof report);
    if (answers_put_status(smr_get_structure_volume(s, structure, &volume)))
        answers_put(&volume, sizeof volume);
    if (answers_put_status(smr_get_local_volume(s, structure, 0.0f, mm)))
        answers_put(mm, 4u * (size_t)n);
    if (answers_put_status(smr_get_normals(s, structure, mm)))
        answers_put(mm, 12u * (size_t)n);
    if (answers_put_status(smr_get_visible(s, structure, (unsigned char *)mm)))
        answers_put_bytes(mm, n);
}

static void say_tick(const smr_tick_report *r)
{
    const uint32_t counts[] = {r->iteration, r->done, r->converged, r->n_forces};
    const float sizes[] = {r->progress, r->residual_mean_mm, r->displacement_max_mm};
    const smr_tick_details *const d = &r->details;
    answers_put(counts, sizeof counts);
    answers_put(sizes, sizeof sizes);
    answers_put(d, offsetof(smr_tick_details, phase_ns));
    answers_put(&d->plastic_updates, sizeof *d - offsetof(smr_tick_details, plastic_updates));
}

void answers_of(smr *s, const smr_model *model, const smr_tick_report *report)
{
    const uint64_t hash = smr_state_hash(s);
    const uint32_t halves[2] = {(uint32_t)hash, (uint32_t)(hash >> 32)};
    smr_model_info info;
    smr_energy energy;
    float weights[SMR_REFERENCES_MAX], places[3u * SMR_LANDMARKS_MAX] = {0};
    uint32_t n = 0;
    answers_need(smr_model_get_info(model, &info) == SMR_OK, "info");
    answers_put(halves, sizeof halves);
    say_tick(report);
    if (answers_put_status(smr_get_reference_weights(s, weights, &n)))
        answers_put(weights, 4u * (size_t)n);
    if (answers_put_status(smr_get_landmarks(s, places)))
        answers_put(places, sizeof places);
    if (answers_put_status(smr_get_energy(s, &energy)))
        answers_put(&energy, sizeof energy);
    answers_say("state");
    for (uint32_t i = 0; i <= info.n_structures; i++) {
        smr_structure_info one = {.n_vertices = 0};
        if (i < info.n_structures)
            answers_need(smr_model_structure(model, i, &one) == SMR_OK, "structure");
        say_structure(s, i < info.n_structures ? i : SMR_ALL, one.n_vertices);
    }
    answers_say("said");
}

smr *answers_init(const smr_model *model, const smr_config *config)
{
    smr *s = NULL;
    size_t bytes = 0;
    answers_need(smr_arena_bytes(model, config, &bytes) == SMR_OK, "arena");
    answers_need(smr_init(model, config, NULL, answers_room(bytes), bytes, &s) == SMR_OK, "init");
    return s;
}

const smr_model *answers_model(const smr_structure *parts, uint32_t n, const smr_prepare_config *config)
{
    const smr_model *model = NULL;
    size_t scratch = 0, bytes = 0;
    answers_need(smr_prepare_bytes(parts, n, config, &scratch) == SMR_OK, "prepare bytes");
    void *const image = answers_room(4u << 20), *const memory = answers_room(scratch);
    answers_need(smr_prepare(parts, n, config, memory, scratch, image, 4u << 20, &bytes) == SMR_OK, "prepare");
    answers_need(smr_model_open(image, bytes, &model) == SMR_OK, "open");
    answers_put_bytes(image, bytes);
    return model;
}
