/* model_view.c: reads what a model contains.
 * SPDX-License-Identifier: MIT */
#include "model/model.h"

uint32_t smr_model_owner(const smr_model *m, uint32_t v)
{
    return smr_index(smr_index_at(smr_at(m, m->at_owner), 2, v), smr_le32(m->n_structures));
}

uint32_t smr_model_position(const smr_model *m, uint32_t i)
{
    return smr_index(smr_word_at(m, m->at_position, i), smr_le32(m->n_vertices));
}

uint32_t smr_model_original(const smr_model *m, uint32_t v)
{
    return smr_index(smr_word_at(m, m->at_original, v), smr_le32(m->n_vertices));
}

smr_lists smr_model_lists(const smr_model *m, uint32_t radius)
{
    const smr_stored_radius *r = smr_model_radius(m, radius);
    return (smr_lists){.block = smr_at(m, r->at_blocks),
                       .entry = smr_at(m, r->at_entries),
                       .count = smr_at(m, r->at_count),
                       .index = smr_at(m, r->at_indexes),
                       .boundary = smr_at(m, r->at_boundary),
                       .n = smr_le32(m->n_vertices),
                       .n_indexes = smr_le32(r->n_indexes),
                       .n_boundary = smr_le32(r->n_boundary),
                       .index_bytes = smr_le32(m->index_bytes),
                       .n_blocks = smr_le32(r->n_blocks),
                       .largest = smr_le32(r->largest),
                       .smallest = smr_le32(r->smallest),
                       .active_min = smr_le32(r->active_min),
                       .members =
                           radius < smr_le32(m->coarse_radii) ? smr_le32(m->coarse_vertices) : smr_le32(m->n_vertices),
                       .radius = smr_le_float(r->radius),
                       .reach = smr_le_float(r->reach)};
}

const smr_stored_section *smr_model_section(const smr_model *m, uint32_t kind)
{
    const smr_stored_section *s = smr_at(m, m->at_sections);
    for (uint32_t i = 0; i < smr_le32(m->n_sections); i++)
        if (smr_le32(s[i].kind) == kind)
            return &s[i];
    return NULL;
}

smr_status smr_model_get_info(const smr_model *model, smr_model_info *info)
{
    if (model == NULL || info == NULL)
        return SMR_E_NULL;
    memset(info, 0, sizeof *info);
    info->n_vertices = smr_le32(model->n_vertices);
    info->n_triangles = smr_le32(model->n_triangles);
    info->n_structures = smr_le32(model->n_structures);
    info->n_radii = smr_le32(model->n_radii);
    smr_store(info->centre, smr_model_centre(model));
    info->edge_mm = smr_le_float(model->edge_mm);
    info->order = smr_le32(model->order);
    info->n_references = smr_max_u32(smr_reference_count(model, smr_model_references(model)), 1u);
    info->profile_samples = smr_le32(model->profile_samples);
    info->profile_step_mm = smr_le_float(model->profile_step);
    info->checksum = smr_le32(model->checksum);
    info->bytes = smr_le32(model->bytes);
    info->n_levels = smr_le32(model->n_levels);
    for (uint32_t i = 0; i < info->n_levels; i++)
        info->level_end[i] = smr_le32(model->level_end[i]);
    for (uint32_t i = 0; i < info->n_radii; i++) {
        const smr_stored_radius *r = smr_model_radius(model, i);
        info->radius_mm[i] = smr_le_float(r->radius);
        info->indexes_per_cluster[i] = (float)smr_le32(r->n_indexes) / (float)info->n_vertices;
        info->direct_per_cluster[i] = smr_le_float(r->mean);
        info->largest_cluster[i] = smr_le32(r->largest);
        info->smallest_cluster[i] = smr_le32(r->smallest);
        info->active_min[i] = smr_le32(r->active_min);
        info->n_blocks[i] = smr_le32(r->n_blocks);
        info->separate[i] = smr_le32(r->separate);
    }
    return SMR_OK;
}

smr_status smr_model_structure(const smr_model *model, uint32_t structure, smr_structure_info *info)
{
    if (model == NULL || info == NULL)
        return SMR_E_NULL;
    if (structure >= smr_le32(model->n_structures))
        return SMR_E_INPUT;
    const smr_stored_structure *r = smr_model_record(model, structure);
    memcpy(info->name, r->name, sizeof info->name);
    info->n_vertices = smr_le32(r->n_vertices);
    info->n_triangles = smr_le32(r->n_triangles);
    return SMR_OK;
}

smr_status smr_model_mesh(const smr_model *model, uint32_t structure, float *xyz, uint32_t *triangles)
{
    if (model == NULL)
        return SMR_E_NULL;
    if (structure >= smr_le32(model->n_structures))
        return SMR_E_INPUT;
    const smr_stored_structure *r = smr_model_record(model, structure);
    const uint32_t first_vertex = smr_le32(r->first_vertex), first_triangle = smr_le32(r->first_triangle);
    const uint32_t *rest = smr_at(model, model->at_rest), *corner = smr_at(model, model->at_triangles);
    const uint32_t *triangle_index = smr_at(model, model->at_triangle_index);
    for (uint32_t i = 0; xyz != NULL && i < smr_le32(r->n_vertices); i++) {
        uint32_t v = smr_model_position(model, first_vertex + i);
        for (uint32_t c = 0; c < 3u; c++)
            xyz[3u * (size_t)i + c] = smr_le_float(rest[3u * (size_t)v + c]) + smr_le_float(model->centre[c]);
    }
    if (triangles != NULL) /* zeros first, because a forged model may give one triangle twice and another never */
        memset(triangles, 0, 3u * (size_t)smr_le32(r->n_triangles) * sizeof *triangles);
    for (uint32_t i = 0; triangles != NULL && i < smr_le32(r->n_triangles); i++) {
        uint32_t *to =
            triangles + 3u * (size_t)smr_index(smr_le32(triangle_index[first_triangle + i]), smr_le32(r->n_triangles));
        for (uint32_t c = 0; c < 3u; c++)
            to[c] = smr_model_original(model, smr_index(smr_le32(corner[3u * (size_t)(first_triangle + i) + c]),
                                                        smr_le32(model->n_vertices))) -
                    first_vertex;
    }
    return SMR_OK;
}
