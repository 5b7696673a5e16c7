/* unit_tree.c: box trees of test meshes, questions to them, and a search of all triangles.
 * SPDX-License-Identifier: MIT */
#include "unit_tree.h"
#include <string.h>
#include "geometry/surface/mesh.h"
#include "geometry/box_tree/triangle.h"

smr_box_tree unit_plant(const unit_mesh *m, uint32_t **triangles)
{
    const smr_mesh view = unit_view(m);
    smr_box_tree f;
    memset(&f, 0, sizeof f);
    smr_tree_shape(&f, m->nt);
    uint32_t *order = rig_rough(4u * (size_t)m->nt), *key = rig_rough(4u * (size_t)m->nt);
    uint32_t *tmp = rig_rough(8u * (size_t)m->nt);
    float *centre = rig_rough(12u * (size_t)m->nt);
    smr_mesh_order(&view, order, centre, key, tmp);
    *triangles = rig_rough(12u * (size_t)m->nt);
    for (uint32_t i = 0; i < m->nt; i++)
        memcpy(*triangles + 3u * (size_t)i, m->triangles + 3u * (size_t)order[i], 12u);
    rig_free(order);
    rig_free(key);
    rig_free(tmp);
    f.xyz = m->xyz;
    f.n_vertices = m->nv;
    f.triangle = *triangles;
    f.normal = centre; /* as large as the normals */
    f.node = rig_rough(sizeof(smr_node) * smr_tree_nodes(m->nt));
    smr_tree_refit_leaves(&f, 0, smr_tree_leaves(&f));
    smr_tree_refit_upper(&f);
    return f;
}

void unit_uproot(smr_box_tree *f, uint32_t *triangles)
{
    rig_free(f->normal);
    rig_free(f->node);
    rig_free(triangles);
}

void unit_closest(const smr_box_tree *f, const smr_query *q, smr_hit *hit)
{
    for (uint32_t i = 0; i < f->n_triangles; i++) {
        const uint32_t *t = f->triangle + 3u * (size_t)i;
        float w[3];
        if (smr_dot(smr_load(f->normal + 3u * (size_t)i), q->normal) < q->min_cos)
            continue;
        const float d2 =
            smr_triangle_closest(q->point, smr_load(f->xyz + 3u * (size_t)t[0]), smr_load(f->xyz + 3u * (size_t)t[1]),
                                 smr_load(f->xyz + 3u * (size_t)t[2]), w);
        if (d2 < hit->d2 || (d2 == hit->d2 && hit->triangle == SMR_NONE)) {
            hit->d2 = d2;
            hit->triangle = i;
            memcpy(hit->weight, w, sizeof w);
        }
    }
}

static smr_vec unit_direction(oracle_random *r)
{
    double m[9];
    oracle_rotation(r, m);
    return smr_v((float)m[0], (float)m[1], (float)m[2]);
}

smr_query unit_query(oracle_random *r, const unit_mesh *m, uint32_t kind)
{
    float p[3];
    oracle_within_box(r, -40, 140, p);
    smr_query q = {smr_load(p), smr_v(0, 0, 0), -2.0f, UINT32_MAX, SMR_NONE};
    if (kind % 3u == 1u) /* a vertex of the mesh: many ties */
        q.point = smr_load(m->xyz + 3u * (size_t)oracle_below(r, m->nv));
    if (kind % 5u == 4u)
        q.warm = oracle_below(r, m->nt);
    if (kind % 4u == 3u) {
        q.normal = unit_direction(r);
        q.min_cos = oracle_uniformf(r, -0.5f, 0.9f);
    }
    return q;
}
