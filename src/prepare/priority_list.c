/* priority_list.c: the priority list S (paper 2.2, complexity tuning): which vertices can be left out of all clusters, least
 * significant first. m_i = min over j in zeta_i of |zeta_j|; the vertex of the largest m_i goes first (ties: the caller's
 * smallest index, so that the list does not depend on how the model lies) and is taken out of the clusters that hold it, its own included, until every m_i is
 * SMR_KEPT or less. Clusters smaller than that from the start therefore stay whole.
 * Several radii share one list: the rule runs at the finest radius until nothing can go, then at the next coarser one
 * among what remains.
 * Cardinalities only fall, so a vertex waits in the bucket of an old m_i and is looked at when its bucket's turn comes:
 * its witness, the cluster where that m_i was found, mostly says at once that it belongs further down.
 * Method: clusters are symmetric (j in zeta_i means i in zeta_j), so the clusters that hold i are those of zeta_i.
 * SPDX-License-Identifier: MIT */
#include "prepare/plan.h"

#include "geometry/hilbert_curve.h"

#define SMR_KEPT 3u    /* vertices that a rigid transform needs */
#define SMR_ASKED 256u /* clusters between two calls of progress */

static int asked_to_stop(smr_plan *p)
{
    return ++p->n_scanned % SMR_ASKED == 0u && p->config->progress != NULL &&
           p->config->progress(p->config->progress_ctx, 0, p->progress_total) != 0;
}

/* Adds `change` (modulo 2^32) to the cardinality of every cluster in the row. */
static void change_counts(smr_plan *p, const uint64_t *row, uint32_t change)
{
    uint32_t *count = p->count;
    for (uint32_t w = smr_row_first(row, p->words), last = smr_row_last(row, p->words); w < last;
         w++, count = p->count) {
        uint64_t rest = row[w];
        count += 64u * (size_t)w;
        for (uint32_t k = 0; rest == UINT64_MAX && k < 64u; k++) /* in large clusters most words are full */
            count[k] += change;
        for (rest = rest == UINT64_MAX ? 0u : rest; rest != 0u; rest &= rest - 1u)
            count[__builtin_ctzll(rest)] += change;
    }
}

/* |zeta_j| over the vertices that remain, for every j. */
static smr_status count_remaining(smr_plan *p, float radius)
{
    memset(p->count, 0, p->n * sizeof *p->count);
    for (uint32_t v = 0; v < p->n; v++) {
        if (p->place[v] != SMR_REMAINS)
            continue;
        smr_cluster_row(p, v, radius, smr_plan_row(p, 0));
        change_counts(p, smr_plan_row(p, 0), 1u);
        if (asked_to_stop(p))
            return SMR_E_ABORTED;
    }
    return SMR_OK;
}

/* The member of a row that is on the list and has the smallest of the caller's indexes; SMR_REMAINS for none. */
static uint32_t first_listed(const smr_plan *p, const uint64_t *row)
{
    uint32_t first = SMR_REMAINS;
    for (uint32_t w = smr_row_first(row, p->words); w < smr_row_last(row, p->words); w++) {
        for (uint64_t rest = row[w]; rest != 0u; rest &= rest - 1u) {
            const uint32_t k = w * 64u + (uint32_t)__builtin_ctzll(rest);
            if (p->place[k] != SMR_REMAINS && (first == SMR_REMAINS || p->original[k] < p->original[first]))
                first = k;
        }
    }
    return first;
}

/* A finer radius does not watch over what its small clusters hold at this one: takes vertices off the list again where
 * fewer than SMR_KEPT are left of a cluster that had more. */
static smr_status restore(smr_plan *p, float radius)
{
    for (uint32_t i = 0; p->n_listed > 0u && i < p->n; i++) {
        const uint32_t v = p->position[i];
        if (p->count[v] >= SMR_KEPT)
            continue;
        smr_cluster_row(p, v, radius, smr_plan_row(p, 0));
        while (p->count[v] < SMR_KEPT) {
            const uint32_t k = first_listed(p, smr_plan_row(p, 0));
            if (k == SMR_REMAINS)
                break;
            p->list[p->place[k]] = SMR_REMAINS;
            p->place[k] = SMR_REMAINS;
            smr_cluster_row(p, k, radius, smr_plan_row(p, 1));
            change_counts(p, smr_plan_row(p, 1), 1u);
        }
        if (asked_to_stop(p))
            return SMR_E_ABORTED;
    }
    return SMR_OK;
}

static void put_in_bucket(smr_plan *p, uint32_t v, uint32_t m)
{
    if (m <= SMR_KEPT)
        return;
    p->next[v] = p->bucket[m];
    p->bucket[m] = v;
}

/* 1 when j is surely in zeta_v: as in clusters.c, without looking at mesh neighbours. */
static int surely_holds(const smr_plan *p, uint32_t v, uint32_t j, float radius)
{
    const float *a = p->xyz + 3u * (size_t)v, *b = p->xyz + 3u * (size_t)j;
    float d2 = 0.0f;
    for (uint32_t c = 0; c < 3u; c++)
        d2 += (a[c] - b[c]) * (a[c] - b[c]);
    return d2 <= radius * radius && p->config->distance == SMR_DISTANCE_EUCLIDEAN &&
           (!p->separate || p->owner[v] == p->owner[j]);
}

/* Takes over a better witness from the neighbours, if one has it. Returns what the witness says. */
static uint32_t ask_neighbours(smr_plan *p, uint32_t v, float radius)
{
    uint32_t tried = 0;
    for (uint32_t i = p->ring_start[v]; i < p->ring_start[v + 1u] && tried < SMR_RING_TRIED; i++, tried++) {
        const uint32_t j = p->witness[p->ring[i]];
        if (p->count[j] < p->count[p->witness[v]] && surely_holds(p, v, j, radius))
            p->witness[v] = j;
    }
    return p->count[p->witness[v]];
}

/* m_v, and the cluster where it is found. Leaves zeta_v in row 0. */
static uint32_t scan(smr_plan *p, uint32_t v, float radius)
{
    const uint64_t *row = smr_plan_row(p, 0);
    uint32_t m = UINT32_MAX;
    smr_cluster_row(p, v, radius, smr_plan_row(p, 0));
    for (uint32_t w = smr_row_first(row, p->words); w < smr_row_last(row, p->words); w++) {
        uint32_t least = 0;
        for (uint32_t k = 0; row[w] == UINT64_MAX && k < 64u; k++)
            least = k == 0u ? p->count[w * 64u] : smr_min_u32(least, p->count[w * 64u + k]);
        if (least >= m)
            continue; /* a full word without a smaller one */
        for (uint64_t rest = row[w]; rest != 0u; rest &= rest - 1u) {
            const uint32_t j = w * 64u + (uint32_t)__builtin_ctzll(rest);
            if (p->count[j] < m) {
                m = p->count[j];
                p->witness[v] = j;
            }
        }
    }
    return m;
}

/* The vertices that wait in bucket m, by the caller's index, into item[]; empties the bucket. Returns how many. */
static uint32_t take_bucket(smr_plan *p, uint32_t m)
{
    uint32_t n = 0, falling = 1;
    for (uint32_t v = p->bucket[m]; v != SMR_REMAINS; v = p->next[v], n++) {
        p->key[n] = p->original[v];
        p->item[n] = v;
        falling &= n == 0u || p->key[n] < p->key[n - 1u];
    }
    p->bucket[m] = SMR_REMAINS;
    for (uint32_t i = 0; falling && i < n / 2u; i++) { /* put there in one go: the last comes first */
        const uint32_t v = p->item[i];
        p->item[i] = p->item[n - 1u - i];
        p->item[n - 1u - i] = v;
    }
    if (!falling)
        smr_curve_sort(p->key, p->item, p->tmp, n);
    return n;
}

/* The paper's rule at one radius among the vertices that remain. */
static smr_status discard(smr_plan *p, float radius)
{
    uint32_t most = 0;
    for (uint32_t v = 0; v < p->n; v++)
        most = smr_max_u32(most, p->count[v]);
    for (uint32_t m = 0; m <= most; m++)
        p->bucket[m] = SMR_REMAINS;
    for (uint32_t i = 0; i < p->n; i++) {
        const uint32_t v = p->position[i];
        p->witness[v] = v;
        if (p->place[v] == SMR_REMAINS)
            put_in_bucket(p, v, p->count[v]);
    }
    for (uint32_t m = most; m > SMR_KEPT; m--) {
        const uint32_t n = take_bucket(p, m);
        for (uint32_t i = 0; i < n; i++) {
            const uint32_t v = p->item[i];
            uint32_t now = p->count[p->witness[v]];
            if (now == m)
                now = ask_neighbours(p, v, radius);
            if (now == m) {
                now = scan(p, v, radius);
                if (asked_to_stop(p))
                    return SMR_E_ABORTED;
            }
            if (now < m) {
                put_in_bucket(p, v, now);
                continue;
            }
            p->place[v] = p->n_listed;
            p->list[p->n_listed++] = v;
            change_counts(p, smr_plan_row(p, 0), UINT32_MAX);
        }
    }
    return SMR_OK;
}

/* Closes the gaps that restore() left, and turns what was listed by the end of each radius into the vertices that it
 * needs. */
static void settle(smr_plan *p, uint32_t n_radii, const uint32_t listed[SMR_RADII_MAX])
{
    uint32_t kept = 0;
    for (uint32_t r = 0; r < n_radii; r++)
        p->active_min[r] = p->n;
    for (uint32_t i = 0; i < p->n_listed; i++) {
        if (p->list[i] == SMR_REMAINS)
            continue;
        for (uint32_t r = 0; r < n_radii; r++)
            p->active_min[r] -= i < listed[r];
        p->list[kept++] = p->list[i];
    }
    p->n_listed = kept;
    for (uint32_t i = 0; i < kept; i++)
        p->place[p->list[i]] = i;
}

smr_status smr_plan_priority(smr_plan *p, const float *radius, uint32_t n_radii, float separate_below)
{
    uint32_t listed[SMR_RADII_MAX] = {0};
    unsigned char done[SMR_RADII_MAX] = {0};
    p->n_listed = p->n_scanned = 0;
    for (uint32_t v = 0; v < p->n; v++)
        p->place[v] = SMR_REMAINS;
    for (uint32_t k = 0; k < n_radii; k++) {
        uint32_t finest = SMR_RADII_MAX;
        for (uint32_t r = n_radii; r-- > 0u;)
            if (!done[r] && (finest == SMR_RADII_MAX || radius[r] < radius[finest]))
                finest = r;
        done[finest] = 1;
        p->separate = radius[finest] < separate_below;
        smr_status status = count_remaining(p, radius[finest]);
        if (status == SMR_OK)
            status = restore(p, radius[finest]);
        if (status == SMR_OK)
            status = discard(p, radius[finest]);
        if (status != SMR_OK)
            return status;
        listed[finest] = p->n_listed;
    }
    settle(p, n_radii, listed);
    return SMR_OK;
}
