/* unit_exercise.c: uses an opened model in every way the library does.
 * SPDX-License-Identifier: MIT */
#include "unit_exercise.h"
#include <string.h>

#define EXERCISE_TICKS 3

static void put32(unsigned char *p, uint32_t v)
{
    for (int i = 0; i < 4; i++)
        p[i] = (unsigned char)(v >> 8 * i);
}

void unit_repair(unsigned char *image, size_t bytes)
{
    if (bytes < 16u)
        return;
    put32(image + 8, (uint32_t)bytes);
    put32(image + 12, oracle_crc(image + 16, bytes - 16u));
}

static const char *read_out(const smr_model *model, const smr_model_info *info)
{
    const char *wrong = NULL;
    for (uint32_t s = 0; s < info->n_structures && wrong == NULL; s++) {
        smr_structure_info one;
        if (smr_model_structure(model, s, &one) != SMR_OK)
            return "smr_model_structure";
        if (memchr(one.name, '\0', sizeof one.name) == NULL)
            return "a name without an end";
        float *xyz = rig_rough(12u * (size_t)one.n_vertices);
        uint32_t *t = rig_rough(12u * (size_t)one.n_triangles); /* filled with 0xa5: not a vertex */
        if (smr_model_mesh(model, s, xyz, t) != SMR_OK)
            wrong = "smr_model_mesh";
        else if (!unit_finite(xyz, 3u * (size_t)one.n_vertices, 4.0f * SMR_COORD_MAX))
            wrong = "rest positions";
        for (size_t i = 0; i < 3u * (size_t)one.n_triangles && wrong == NULL; i++)
            if (t[i] >= one.n_vertices)
                wrong = "a triangle's corner out of range or never written";
        rig_free(xyz);
        rig_free(t);
    }
    return wrong;
}

static const char *check_positions(const smr *s, const smr_model_info *info, const smr_model *model)
{
    const char *wrong = NULL;
    for (uint32_t k = 0; k < info->n_structures && wrong == NULL; k++) {
        smr_structure_info one;
        (void)smr_model_structure(model, k, &one);
        float *xyz = rig_rough(12u * (size_t)one.n_vertices);
        const size_t n = 3u * (size_t)one.n_vertices;
        if (smr_get_positions(s, k, xyz) != SMR_OK || !unit_finite(xyz, n, 1e30f))
            wrong = "positions";
        else if (smr_get_normals(s, k, xyz) != SMR_OK || !unit_finite(xyz, n, 1.01f))
            wrong = "normals";
        rig_free(xyz);
    }
    return wrong;
}

/* The measures as numbers, in the order of the struct behind level and reasons. */
static int finite_verdict(const smr_verdict *v)
{
    const float share[] = {v->visible_share, v->target_covered, v->normals_agree, v->goals_share};
    const float rest[] = {v->expected_error_mm, v->residual_mm,  v->image_similarity, v->strain,
                          v->stretch,           v->volume_ratio, v->turned_deg,       v->rotation_deg,
                          v->bend_mm,           v->scale,        v->scale_rest,       v->moved_last_mm};
    for (size_t i = 0; i < sizeof share / sizeof share[0]; i++)
        if (!(share[i] == -1.0f || (share[i] >= 0.0f && share[i] <= 1.0001f)))
            return 0;
    return v->level <= SMR_VERDICT_FAILED && unit_finite(rest, sizeof rest / sizeof rest[0], 1e30f);
}

/* Judges all and each structure. */
static const char *check_verdict(smr *s, const smr_model_info *info, const smr_model *model)
{
    const char *wrong = NULL;
    smr_verdict v;
    if (smr_get_verdict(s, SMR_ALL, &v) != SMR_OK || !finite_verdict(&v))
        return "the verdict";
    for (uint32_t k = 0; k < info->n_structures && wrong == NULL; k++) {
        smr_structure_info one;
        (void)smr_model_structure(model, k, &one);
        float *mm = rig_rough(4u * (size_t)one.n_vertices);
        unsigned char *seen = rig_rough(one.n_vertices);
        if (smr_get_verdict(s, k, &v) != SMR_OK || !finite_verdict(&v))
            wrong = "a structure's verdict";
        else if (smr_get_expected_error(s, k, mm) != SMR_OK || !unit_finite(mm, one.n_vertices, 1e30f))
            wrong = "expected errors";
        else if (smr_get_local_volume(s, k, 5.0f * (float)k, mm) != SMR_OK || !unit_finite(mm, one.n_vertices, 1e6f))
            wrong = "local volumes";
        else if (smr_get_visible(s, k, seen) != SMR_OK || (one.n_vertices > 0u && seen[one.n_vertices - 1u] > 1u))
            wrong = "what is seen";
        rig_free(mm);
        rig_free(seen);
    }
    return wrong;
}

static const char *run(const smr_model *model, const smr_model_info *info, const smr_surface *target, smr_config *c,
                       int judged)
{
    size_t bytes = 0;
    smr *s = NULL;
    const char *wrong = NULL;
    if (smr_arena_bytes(model, c, &bytes) != SMR_OK)
        return "smr_arena_bytes";
    if (bytes > (size_t)256 << 20)
        return NULL; /* large images are not what this is about */
    void *arena = rig_rough(bytes);
    if (smr_init(model, c, NULL, arena, bytes, &s) != SMR_OK)
        wrong = "smr_init";
    else if (target != NULL && smr_set_surface(s, SMR_ALL, target) != SMR_OK)
        wrong = "smr_set_surface";
    for (int i = 0; i < EXERCISE_TICKS && wrong == NULL; i++) {
        smr_tick_report report;
        if (smr_tick(s, 0, &report) != SMR_OK)
            wrong = "smr_tick";
        else if (!unit_finite(&report.residual_mean_mm, 1, 1e30f) ||
                 !unit_finite(&report.displacement_max_mm, 1, 1e30f))
            wrong = "the report";
        else
            wrong = check_positions(s, info, model);
    }
    if (wrong == NULL && judged)
        wrong = check_verdict(s, info, model);
    rig_free(arena);
    return wrong;
}

const char *unit_exercise(const smr_model *model, const smr_surface *target, uint32_t target_vertices, uint32_t how)
{
    smr_model_info info;
    if (smr_model_get_info(model, &info) != SMR_OK)
        return "smr_model_get_info";
    const char *wrong = read_out(model, &info);
    smr_config c = smr_config_default();
    c.basic.n_target_vertices = target_vertices;
    c.basic.iterations = c.basic.iterations_last = 1; /* each tick another radius */
    if (wrong == NULL)
        wrong = run(model, &info, target, &c, (how & UNIT_JUDGED) != 0u);
    c.basic.method = SMR_METHOD_POLAR;
    c.motion.normals = SMR_NORMALS_EXACT;
    c.schedule.radius_first = info.n_radii - 1u;
    if (wrong == NULL && (how & UNIT_POLAR))
        wrong = run(model, &info, target, &c, (how & UNIT_JUDGED) != 0u);
    return wrong;
}
