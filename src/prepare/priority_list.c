/* priority_list.c: the priority list S (paper 2.2, complexity tuning), the vertices that can be ignored, the least
 * significant first; and the stored order that follows from S: by levels, the most important first, and along the curve
 * within a level, so that the first m stored vertices are about the best m to keep active. A level ends with the
 * active_min of each radius.
 * Rule: m_i = min over j in zeta_i of |zeta_j|. The vertex with the largest m_i goes into S and out of all clusters
 * that hold it, until every m_i is SMR_KEPT or less. Of equal m_i the caller's smallest index goes first, so that S
 * does not depend on the model's pose. The rule runs at the finest radius until no vertex can go, then at the next
 * coarser radius among the vertices that remain.
 * Method: |zeta_j| only falls. A vertex therefore waits in the bucket of its last known m_i and is tested again when
 * that bucket comes up. The vertex' witness, the cluster where m_i was found, mostly shows at once that m_i has fallen.
 * Clusters are symmetric, so the clusters that hold i are those of the vertices in zeta_i.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/hilbert_curve.h"
#include "prepare/prepare_plan.h"

#define SMR_KEPT 3u        /* fewest active vertices of a cluster: three determine a rigid transform */
#define SMR_REQUESTED 256u /* number of clusters computed between two calls of the progress callback */

/* Counts one more computed cluster. Returns 1 when the progress callback wants to stop. */
static int stop_requested(smr_plan *p)
{
    return ++p->priority.n_scanned % SMR_REQUESTED == 0u && p->config->progress != NULL &&
           p->config->progress(p->config->progress_ctx, 0, p->progress_total) != 0;
}

/* Adds `change` (modulo 2^32) to the count |zeta_j| of every vertex j in the row. */
static void change_counts(smr_plan *p, const uint64_t *row, uint32_t change)
{
    for (uint32_t w = smr_row_first(row, p->words), last = smr_row_last(row, p->words); w < last; w++) {
        uint64_t rest = row[w];
        uint32_t *const count = p->count + 64u * (size_t)w;
        for (uint32_t k = 0; rest == UINT64_MAX && k < 64u; k++) /* most words of large clusters have all bits set */
            count[k] += change;
        for (rest = rest == UINT64_MAX ? 0u : rest; rest != 0u; rest &= rest - 1u)
            count[__builtin_ctzll(rest)] += change;
    }
}

/* Clusters of the vertices p->item[first .. last-1], rows first: the argument of a parallel loop. */
typedef struct cluster_batch {
    smr_plan *p;
    uint32_t first, last;
    float radius; /* mm */
} cluster_batch;

#define SMR_BATCH_CHUNK 16u /* number of clusters that a task computes */

static void fill_batch(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const cluster_batch *b = arg;
    const uint32_t from = b->first + task * SMR_BATCH_CHUNK, to = smr_min_u32(from + SMR_BATCH_CHUNK, b->last);
    for (uint32_t i = from; i < to; i++)
        (void)smr_cluster_row(b->p, b->p->item[i], b->radius, smr_plan_row(b->p, i - b->first));
}

/* Computes p->count[j], the number of vertices of zeta_j that are not in S. */
static smr_status count_remaining(smr_plan *p, float radius)
{
    uint32_t n = 0;
    memset(p->count, 0, p->n * sizeof *p->count);
    for (uint32_t v = 0; v < p->n; v++)
        if (p->priority.place[v] == SMR_REMAINS)
            p->item[n++] = v;
    const uint32_t size = smr_min_u32(p->n_rows, SMR_REQUESTED);
    for (uint32_t first = 0; first < n; first += size) {
        cluster_batch b = {p, first, smr_min_u32(first + size, n), radius};
        if (!smr_fork(&p->port, fill_batch, &b, smr_ceil_div(b.last - first, SMR_BATCH_CHUNK)))
            return SMR_E_STATE;
        for (uint32_t i = first; i < b.last; i++) {
            change_counts(p, smr_plan_row(p, i - first), 1u);
            if (stop_requested(p))
                return SMR_E_ABORTED;
        }
    }
    return SMR_OK;
}

/* Returns the row's vertex in S with the caller's smallest index; SMR_REMAINS when no vertex of the row is in S. */
static uint32_t first_listed(const smr_plan *p, const uint64_t *row)
{
    uint32_t first = SMR_REMAINS;
    for (uint32_t w = smr_row_first(row, p->words); w < smr_row_last(row, p->words); w++)
        for (uint64_t rest = row[w]; rest != 0u; rest &= rest - 1u) {
            const uint32_t k = w * 64u + (uint32_t)__builtin_ctzll(rest);
            if (p->priority.place[k] != SMR_REMAINS && (first == SMR_REMAINS || p->original[k] < p->original[first]))
                first = k;
        }
    return first;
}

/* Takes vertices off S until each cluster of this radius, mm, has SMR_KEPT or all of its vertices outside S. */
static smr_status restore(smr_plan *p, float radius)
{
    for (uint32_t i = 0; p->priority.n_listed > 0u && i < p->n; i++) {
        const uint32_t v = p->position[i];
        if (p->count[v] >= SMR_KEPT)
            continue;
        (void)smr_cluster_row(p, v, radius, smr_plan_row(p, 0));
        while (p->count[v] < SMR_KEPT) {
            const uint32_t k = first_listed(p, smr_plan_row(p, 0));
            if (k == SMR_REMAINS)
                break;
            p->priority.list[p->priority.place[k]] = SMR_REMAINS;
            p->priority.place[k] = SMR_REMAINS;
            (void)smr_cluster_row(p, k, radius, smr_plan_row(p, 1));
            change_counts(p, smr_plan_row(p, 1), 1u);
        }
        if (stop_requested(p))
            return SMR_E_ABORTED;
    }
    return SMR_OK;
}

/* Puts vertex v into bucket m, unless m is SMR_KEPT or less: v must then stay active. */
static void put_in_bucket(smr_plan *p, uint32_t v, uint32_t m)
{
    if (m <= SMR_KEPT)
        return;
    p->priority.next[v] = p->priority.bucket[m];
    p->priority.bucket[m] = v;
}

/* Returns 1 when j is in zeta_v by Euclidean distance (cluster_building.c); mesh neighbours are not tested. */
static int surely_holds(const smr_plan *p, uint32_t v, uint32_t j, float radius)
{
    const float d2 = smr_distance2(smr_get3(p->xyz, v), smr_get3(p->xyz, j));
    return d2 <= radius * radius && p->config->distance == SMR_DISTANCE_EUCLIDEAN && !smr_kept_apart(p, v, j);
}

/* Replaces the witness of v by a mesh neighbour's witness whose cluster is smaller. Returns |zeta| of v's witness. */
static uint32_t ask_neighbours(smr_plan *p, uint32_t v, float radius)
{
    const uint32_t first = p->neighbour_start[v];
    for (uint32_t i = first; i < smr_min_u32(p->neighbour_start[v + 1u], first + SMR_NEIGHBOURS_TRIED); i++) {
        const uint32_t j = p->priority.witness[p->neighbour[i]];
        if (p->count[j] < p->count[p->priority.witness[v]] && surely_holds(p, v, j, radius))
            p->priority.witness[v] = j;
    }
    return p->count[p->priority.witness[v]];
}

/* Returns m_v: the smallest cluster size |zeta_j| of j in v's cluster zeta_v; j is v's witness. Row 0 holds zeta_v. */
static uint32_t scan(smr_plan *p, uint32_t v, float radius)
{
    uint64_t *const row = smr_plan_row(p, 0);
    uint32_t m = UINT32_MAX;
    (void)smr_cluster_row(p, v, radius, row);
    for (uint32_t w = smr_row_first(row, p->words); w < smr_row_last(row, p->words); w++) {
        uint32_t least = 0;
        for (uint32_t k = 0; row[w] == UINT64_MAX && k < 64u; k++)
            least = k == 0u ? p->count[w * 64u] : smr_min_u32(least, p->count[w * 64u + k]);
        if (least >= m)
            continue; /* skips a word of 64 vertices with no cluster smaller than m */
        for (uint64_t rest = row[w]; rest != 0u; rest &= rest - 1u) {
            const uint32_t j = w * 64u + (uint32_t)__builtin_ctzll(rest);
            if (p->count[j] < m) {
                m = p->count[j];
                p->priority.witness[v] = j;
            }
        }
    }
    return m;
}

/* Moves the vertices of bucket m into p->item, sorted by the caller's index. Returns their number. */
static uint32_t take_bucket(smr_plan *p, uint32_t m)
{
    uint32_t n = 0, falling = 1;
    for (uint32_t v = p->priority.bucket[m]; v != SMR_REMAINS; v = p->priority.next[v], n++) {
        p->key[n] = p->original[v];
        p->item[n] = v;
        falling &= n == 0u || p->key[n] < p->key[n - 1u];
    }
    p->priority.bucket[m] = SMR_REMAINS;
    for (uint32_t i = 0; falling && i < n / 2u; i++) { /* a bucket filled in ascending order only needs reversing */
        const uint32_t v = p->item[i];
        p->item[i] = p->item[n - 1u - i];
        p->item[n - 1u - i] = v;
    }
    if (!falling)
        smr_curve_sort(p->key, p->item, p->tmp, n);
    return n;
}

/* Puts each vertex v into the bucket of |zeta_v|, an upper bound of m_v. Returns the largest |zeta_v|. */
static uint32_t fill_buckets(smr_plan *p)
{
    uint32_t most = 0;
    for (uint32_t v = 0; v < p->n; v++)
        most = smr_max_u32(most, p->count[v]);
    for (uint32_t m = 0; m <= most; m++)
        p->priority.bucket[m] = SMR_REMAINS;
    for (uint32_t i = 0; i < p->n; i++) {
        const uint32_t v = p->position[i];
        p->priority.witness[v] = v;
        if (p->priority.place[v] == SMR_REMAINS)
            put_in_bucket(p, v, p->count[v]);
    }
    return most;
}

/* Moves vertices that are not in S yet into S, by the paper's rule at one radius. */
static smr_status discard(smr_plan *p, float radius)
{
    for (uint32_t m = fill_buckets(p); m > SMR_KEPT; m--) {
        const uint32_t n = take_bucket(p, m);
        for (uint32_t i = 0; i < n; i++) {
            const uint32_t v = p->item[i];
            uint32_t now = p->count[p->priority.witness[v]];
            if (now == m)
                now = ask_neighbours(p, v, radius);
            if (now == m) {
                now = scan(p, v, radius);
                if (stop_requested(p))
                    return SMR_E_ABORTED;
            }
            if (now < m) {
                put_in_bucket(p, v, now);
                continue;
            }
            p->priority.place[v] = p->priority.n_listed;
            p->priority.list[p->priority.n_listed++] = v;
            change_counts(p, smr_plan_row(p, 0), UINT32_MAX);
        }
    }
    return SMR_OK;
}

/* Closes the gaps in S, so that the list never holds more than all vertices. listed[r]: length of S after radius r. */
static void close_gaps(smr_plan *p, uint32_t listed[SMR_RADII_MAX])
{
    uint32_t kept = 0, before[SMR_RADII_MAX] = {0};
    for (uint32_t i = 0; i < p->priority.n_listed; i++) {
        const uint32_t v = p->priority.list[i];
        if (v == SMR_REMAINS)
            continue;
        for (uint32_t r = 0; r < SMR_RADII_MAX; r++)
            before[r] += i < listed[r];
        p->priority.place[v] = kept;
        p->priority.list[kept++] = v;
    }
    memcpy(listed, before, sizeof before);
    p->priority.n_listed = kept;
}

smr_status smr_plan_priority(smr_plan *p, const float *radius, uint32_t n_radii, float separate_below, int empty)
{
    uint32_t listed[SMR_RADII_MAX] = {0};
    unsigned char done[SMR_RADII_MAX] = {0};
    p->priority.n_listed = p->priority.n_scanned = 0;
    for (uint32_t v = 0; v < p->n; v++)
        p->priority.place[v] = SMR_REMAINS;
    for (uint32_t k = 0; k < n_radii && !empty; k++) {
        uint32_t finest = SMR_RADII_MAX;
        for (uint32_t r = n_radii; r-- > 0u;)
            if (!done[r] && (finest == SMR_RADII_MAX || radius[r] < radius[finest]))
                finest = r;
        done[finest] = 1;
        p->separate = radius[finest] < separate_below;
        SMR_TRY(count_remaining(p, radius[finest]));
        SMR_TRY(restore(p, radius[finest]));
        close_gaps(p, listed);
        SMR_TRY(discard(p, radius[finest]));
        listed[finest] = p->priority.n_listed;
    }
    for (uint32_t r = 0; r < n_radii; r++)
        p->active_min[r] = p->n - listed[r];
    return SMR_OK;
}

#define SMR_LEVEL_EIGHTHS 16u /* each level ends at 16/8 times the number of vertices where the level before ends */

/* Sets n_levels and level_end: levels end at each of need[n] (ascending), and in between while there is room. */
static void choose_ends(smr_plan *p, const uint32_t *need, uint32_t n)
{
    uint32_t end[SMR_LEVELS_MAX], n_ends = 0; /* ends of levels, from the last to the first */
    for (uint32_t i = n; i-- > 0u;) {
        const uint32_t below = i > 0u ? need[i - 1u] : need[0];
        end[n_ends++] = need[i];
        for (;;) {
            const uint32_t between = (uint32_t)((uint64_t)end[n_ends - 1u] * 8u / SMR_LEVEL_EIGHTHS);
            if (n_ends + i >= SMR_LEVELS_MAX || between <= below + below / 8u)
                break;
            end[n_ends++] = between;
        }
    }
    p->n_levels = n_ends;
    for (uint32_t i = 0; i < n_ends; i++)
        p->level_end[i] = end[n_ends - 1u - i];
}

/* Fills need[] with the distinct active_min of all radii and the number of vertices, ascending. Returns how many. */
static uint32_t sorted_needs(const smr_plan *p, uint32_t n_radii, uint32_t need[SMR_RADII_MAX + 1u])
{
    uint32_t n = 0, last = 0;
    for (;;) {
        uint32_t next = p->n;
        for (uint32_t r = 0; r < n_radii; r++)
            if (p->active_min[r] > last)
                next = smr_min_u32(next, p->active_min[r]);
        need[n++] = last = next;
        if (next == p->n)
            return n;
    }
}

void smr_plan_levels(smr_plan *p, uint32_t n_radii)
{
    uint32_t need[SMR_RADII_MAX + 1u];
    choose_ends(p, need, sorted_needs(p, n_radii, need));
    for (uint32_t v = 0; v < p->n; v++) {
        const uint32_t rank = p->priority.place[v] == SMR_REMAINS ? 0u : p->n - 1u - p->priority.place[v];
        uint32_t level = 0;
        while (rank >= p->level_end[level])
            level++;
        p->key[v] = p->level[v] = level;
        p->along[v] = v;
    }
    smr_curve_sort(p->key, p->along, p->tmp, p->n); /* sorts by level; stable: a level follows the curve */
    for (uint32_t v = 0; v < p->n; v++)
        p->stored[p->along[v]] = v;
}
