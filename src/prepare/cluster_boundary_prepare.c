/* cluster_boundary_prepare.c: vertices near the cluster boundary get fractional weight.
 * Rounding would decide whether two vertices about a radius apart are in each other's cluster. Over a narrow range of
 * distances around the radius the weight therefore falls linearly from 1 to 0. The lists zeta+ and zeta- follow d <= r;
 * a boundary pair holds its weight less the lists' 1 or 0. Geodesic distances are whole micrometres, without boundary.
 * Bounds: for each vertex near a boundary one visit to the boxes of the tree that its boundary crosses.
 * SPDX-License-Identifier: MIT */
#include "prepare/prepare_plan.h"

static int mesh_neighbour(const smr_plan *p, uint32_t v, uint32_t other)
{
    for (uint32_t i = p->neighbour_start[v]; i < p->neighbour_start[v + 1u]; i++)
        if (p->neighbour[i] == other)
            return 1;
    return 0;
}

/* Writes the pair a, b if its weight differs from the lists'; counts pairs beyond the radius. half: half width, mm. */
static void write_pair(smr_plan *p, smr_list_writer *l, uint32_t a, uint32_t b, float radius, float half)
{
    const float d2 = smr_distance2(smr_get3(p->xyz, a), smr_get3(p->xyz, b));
    const float share = smr_clamp(0.5f + (radius - SMR_SQRT(d2)) / (2.0f * half), 0.0f, 1.0f);
    const int inside = d2 <= radius * radius, units = (int)(share * (float)SMR_BOUNDARY_UNITS + 0.5f);
    const int add = units - (inside ? SMR_BOUNDARY_UNITS : 0);
    if (add == 0 || !(smr_is_member(p, a) || smr_is_member(p, b)) || smr_kept_apart(p, a, b) ||
        (smr_holds_neighbours(p, radius) && mesh_neighbour(p, a, b)))
        return;
    const uint32_t field[3] = {p->stored[a], p->stored[b], (uint32_t)(add + SMR_BOUNDARY_UNITS / 2)};
    smr_put_words(l->w, l->at_boundary + (size_t)l->n_boundary * sizeof(smr_stored_boundary), field, 3);
    l->n_boundary++;
    p->n_outside[a] += !inside;
    p->n_outside[b] += !inside;
}

/* Writes the boundary pairs of v and vertices with larger numbers. half: half the boundary's width, mm. */
static void find_pairs(smr_plan *p, smr_list_writer *l, uint32_t v, float radius, float half)
{
    const smr_vec at = smr_get3(p->xyz, v);
    const smr_boundary b = smr_boundary_at(radius);
    smr_visit stack[SMR_TREE_LEVELS * SMR_TREE_WIDTH];
    uint32_t top = 0;
    stack[top++] = (smr_visit){0.0f, p->points.n_levels - 1u, 0u};
    while (top > 0u) {
        const smr_visit node = stack[--top];
        const smr_node *boxes = &p->points.node[p->points.level[node.level] + node.index];
        uint32_t in; /* children that the boundary crosses, a bit each */
        if (node.level > 0u) {
            (void)smr_box_kinds(boxes, at, b.near2, b.far2, &in);
        } else {
            const uint32_t within = smr_leaf_members(boxes, at, b.near2, b.far2, &in);
            in &= ~within;
        }
        for (; in != 0u; in &= in - 1u) {
            const uint32_t child = node.index * SMR_TREE_WIDTH + (uint32_t)__builtin_ctz(in);
            if ((uint64_t)(child + 1u) << (3u * node.level) <= (uint64_t)v + 1u ||
                (uint64_t)child << (3u * node.level) >= p->n)
                continue; /* skips a child with vertices up to v only, or behind the last vertex */
            if (node.level > 0u)
                stack[top++] = (smr_visit){0.0f, node.level - 1u, child};
            else
                write_pair(p, l, v, child, radius, half);
        }
    }
}

void smr_write_boundary(smr_plan *p, smr_list_writer *l, float radius)
{
    const float half = smr_boundary_at(radius).half;
    l->at_boundary = smr_put_section(l->w, 0);
    memset(p->n_outside, 0, p->n * sizeof *p->n_outside);
    for (uint32_t v = 0; v < p->n && p->config->distance != SMR_DISTANCE_GEODESIC; v++) {
        if (l->at_boundary + l->n_boundary * sizeof(smr_stored_boundary) > UINT32_MAX)
            break; /* stops: smr_prepare() will report the model as too large */
        if (p->touched[v] || (p->members > 0u && smr_is_member(p, v))) /* touched[v] tells of members only */
            find_pairs(p, l, v, radius, half);
    }
    l->w->used = l->at_boundary + (size_t)l->n_boundary * sizeof(smr_stored_boundary);
    for (uint32_t v = 0; v < p->n; v++) /* finds the largest cluster; boundary vertices outside the radius count half */
        l->largest = smr_max_u32(l->largest, p->count[v] + (p->n_outside[v] + 1u) / 2u);
}
