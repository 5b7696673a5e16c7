/* fold_limit.c: at the finest radii, holds back the steps x_next - x that would fold hinges. A hinge may come nearer to its limit by
 * a share of what is left in an iteration. Where its cosine would fall by more, the steps of its four corners become more
 * alike: so far towards their mean as it takes, for corners that all move alike do not turn it. Vertices of several such
 * hinges go by the mean of what these ask, the nearer to it the more the most urgent asks. Hinges that share corners pull
 * each other along, so that is done a few times over. All this is continuous in the positions: who is close to a limit by
 * a last bit is moved by a last bit.
 * What would fold even so has its steps halved, and at last stays where it was, which did not fold.
 * Each round depends on the one before: one task after the other, each a piece of a pass.
 * Bounds: SMR_BRAKE_ROUNDS passes over the hinges, and SMR_SOFT_ROUNDS over triangles and vertices of the structures that fold.
 * SPDX-License-Identifier: MIT */
#include "geometry/triangle.h"
#include "runtime/folds/folds.h"

#define SMR_BRAKE_SHARE                                                                                                \
    0.75f /* of the way down to its limit and the room before it, so much may a hinge go in an iteration */
#define SMR_BRAKE_ROOM 0.05f   /* cosine: within it of the limit it only creeps, */
#define SMR_BRAKE_CREEP 0.001f /* so much in an iteration, */
#define SMR_BRAKE_LEFT 0.05f   /* and no more than this share of what is left: it does not get there */
#define SMR_LOOK_CHUNK 64u     /* hinges of a task: each takes two triangles' normals, twice */
#define SMR_SOFT_ROUNDS 20u
#define SMR_HALVINGS 3u
#define SMR_BRAKE_ROUNDS 40u
#define SMR_ENOUGH 0.001f /* a round that asks for less everywhere is the last one of the soft ones */

enum { SMR_BRAKE_IDLE = 0, SMR_BRAKE_LOOK, SMR_BRAKE_TOUCH, SMR_BRAKE_MOVE };
enum { SMR_MARKED = 1, SMR_ASKED = 2 };

/* How far the steps of a hinge's corners must become alike, 0 .. 1, when its cosine would be `next`. */
float smr_brake_share(const smr *s, const smr_stored_hinge *h, float next)
{
    const float limit = smr_hinge_limit(smr_le32(h->bend)), near = limit + SMR_BRAKE_ROOM;
    if (!(next < 1.0f - SMR_BRAKE_SHARE * (1.0f - near)))
        return 0.0f; /* not even from flat */
    const float now = smr_hinge_cosine(s, s->x, h);
    const float creep = smr_min(SMR_BRAKE_CREEP, SMR_BRAKE_LEFT * smr_abs(now - limit));
    const float may = SMR_BRAKE_SHARE * smr_positive(now - near) + creep;
    return now - next > may ? 1.0f - may / (now - next) : 0.0f;
}

static int any_marked(const smr *s, uint32_t triangle)
{
    const uint32_t *t = s->triangle + 3u * (size_t)triangle;
    return s->guard[t[0]] | s->guard[t[1]] | s->guard[t[2]];
}

static smr_vec step_of(const smr *s, uint32_t v)
{
    return smr_sub(smr_load(smr_at3(s->x_next, v)), smr_load(smr_at3(s->x, v)));
}

/* The four corners of a hinge: the first triangle's, and the second's that the first does not have. */
static void corners_of(const smr *s, const smr_stored_hinge *h, uint32_t corner[4])
{
    const uint32_t *a = s->triangle + 3u * (size_t)smr_le32(h->first),
                   *b = s->triangle + 3u * (size_t)smr_hinge_second(h);
    memcpy(corner, a, 3u * sizeof *a);
    corner[3] = a[0];
    for (uint32_t c = 0; c < 3u; c++)
        if (b[c] != a[0] && b[c] != a[1] && b[c] != a[2])
            corner[3] = b[c];
}

static void ask(smr *s, const smr_stored_hinge *h, float share)
{
    uint32_t corner[4];
    corners_of(s, h, corner);
    smr_vec mean = smr_v(0, 0, 0);
    for (uint32_t c = 0; c < 4u; c++)
        mean = smr_add(mean, smr_scale(step_of(s, corner[c]), 0.25f));
    for (uint32_t c = 0; c < 4u; c++) {
        const uint32_t v = corner[c];
        float *sum = smr_at3(s->ring_sum, v), *most = smr_at3(s->displaced, v);
        if (!(s->guard[v] & SMR_ASKED)) {
            smr_store(sum, smr_v(0, 0, 0));
            s->ring_weight[v] = *most = 0.0f;
        }
        smr_store(sum, smr_add(smr_load(sum), smr_scale(mean, share)));
        s->ring_weight[v] += share;
        *most = smr_max(*most, share);
        s->guard[v] = SMR_MARKED | SMR_ASKED;
    }
    s->part[smr_model_owner(s->model, corner[0])].folding = 1;
}

/* Shortens the steps of a hinge's corners. */
static void hold(smr *s, const smr_stored_hinge *h, float keep)
{
    uint32_t corner[4];
    corners_of(s, h, corner);
    for (uint32_t c = 0; c < 4u; c++) {
        const smr_vec step = smr_scale(step_of(s, corner[c]), keep);
        smr_store(smr_at3(s->x_next, corner[c]), smr_add(smr_load(smr_at3(s->x, corner[c])), step));
        s->guard[corner[c]] |= SMR_MARKED;
        smr_hold(s, corner[c], 1.0f);
    }
}

static int touched(const smr *s, uint32_t triangle)
{
    const uint32_t run = triangle >> s->brake.run_bits;
    return (int)(s->brake.touched[run / 64u] >> (run % 64u) & 1u);
}

static void look(smr *s, uint32_t from, uint32_t to)
{
    smr_brake *b = &s->brake;
    for (uint32_t i = from; i < to; i++) {
        const smr_stored_hinge *h = smr_hinge_at(s, i);
        const uint32_t first = smr_le32(h->first), second = smr_hinge_second(h);
        if (b->round == 0u ? s->tally[i / SMR_HINGE_CHUNK].n_rejected == 0u
                           : (b->round <= SMR_SOFT_ROUNDS && !touched(s, first) && !touched(s, second)) ||
                                 (!any_marked(s, first) && !any_marked(s, second)))
            continue;
        const float next = smr_hinge_cosine(s, s->x_next, h), limit = smr_hinge_limit(smr_le32(h->bend));
        if (b->round < SMR_SOFT_ROUNDS) {
            const float share = smr_brake_share(s, h, next);
            if (share > 0.0f) {
                ask(s, h, share);
                b->most = smr_max(b->most, share);
            }
        } else if (next < limit && !(smr_hinge_cosine(s, s->x, h) < limit)) {
            hold(s, h, b->round < SMR_SOFT_ROUNDS + SMR_HALVINGS ? 0.5f : 0.0f);
            b->most = 1.0f;
        }
    }
}

static void touch(smr *s, uint32_t triangle, uint32_t last)
{
    for (; triangle < last; triangle++) {
        const uint32_t run = triangle >> s->brake.run_bits;
        if (any_marked(s, triangle))
            s->brake.touched[run / 64u] |= (uint64_t)1 << (run % 64u);
    }
}

static void move(smr *s, uint32_t from, uint32_t to)
{
    for (uint32_t i = from; i < to; i++) {
        const uint32_t v = smr_model_position(s->model, i);
        if (!(s->guard[v] & SMR_ASKED))
            continue;
        const smr_vec mean = smr_scale(smr_load(smr_at3(s->ring_sum, v)), 1.0f / s->ring_weight[v]),
                      step = step_of(s, v);
        const float most = *smr_at3(s->displaced, v);
        const smr_vec kept = smr_add(step, smr_scale(smr_sub(mean, step), most));
        smr_store(smr_at3(s->x_next, v), smr_add(smr_load(smr_at3(s->x, v)), kept));
        s->guard[v] = SMR_MARKED;
        smr_hold(s, v, most);
    }
}

/* The next structure that folds, from `part` on; n_parts for none. */
static uint32_t folding_from(const smr *s, uint32_t part)
{
    while (part < s->n_parts && !s->part[part].folding)
        part++;
    return part;
}

/* On to the next structure that folds, from b->part on, and with the stage that comes next behind the last one. */
static void next_part(smr *s, uint32_t stage)
{
    smr_brake *b = &s->brake;
    b->part = folding_from(s, b->part);
    if (b->part == s->n_parts && stage == SMR_BRAKE_TOUCH) {
        stage = SMR_BRAKE_MOVE;
        b->part = folding_from(s, 0);
    }
    b->stage = stage;
    if (b->part < s->n_parts)
        return;
    b->part = 0;
    b->stage = SMR_BRAKE_LOOK;
    b->round = b->most < SMR_ENOUGH && b->round < SMR_SOFT_ROUNDS ? SMR_SOFT_ROUNDS : b->round + 1u;
    b->most = 0.0f;
}

static void next_pass(smr *s)
{
    smr_brake *b = &s->brake;
    b->at = 0;
    if (b->stage != SMR_BRAKE_LOOK) {
        b->part++;
        next_part(s, b->stage);
        return;
    }
    const int soft = b->round < SMR_SOFT_ROUNDS;
    b->part = 0;
    if (soft && b->most > 0.0f) {
        next_part(s, SMR_BRAKE_TOUCH);
    } else if (soft) {
        b->round = SMR_SOFT_ROUNDS;
    } else {
        b->stage = b->most > 0.0f && ++b->round < SMR_BRAKE_ROUNDS ? SMR_BRAKE_LOOK : SMR_BRAKE_IDLE;
        b->most = 0.0f;
    }
}

void smr_brake_start(smr *s)
{
    memset(&s->brake, 0, sizeof s->brake);
    s->brake.stage = SMR_BRAKE_LOOK;
    while (s->n_triangles >> s->brake.run_bits >= SMR_MEND_RUNS)
        s->brake.run_bits++;
}

uint32_t smr_brake_tasks(smr *s) { return s->brake.stage == SMR_BRAKE_IDLE ? s->next_task : s->next_task + 1u; }

/* A piece of the pass under way. */
void smr_brake_pass(void *arg, uint32_t task, uint32_t worker)
{
    smr *s = arg;
    smr_brake *b = &s->brake;
    const smr_part *part = &s->part[b->part];
    const uint32_t length = b->stage == SMR_BRAKE_LOOK   ? s->n_hinges
                            : b->stage == SMR_BRAKE_MOVE ? part->n_vertices
                                                         : part->facets.n_triangles;
    const uint32_t chunk = b->stage == SMR_BRAKE_LOOK ? SMR_LOOK_CHUNK : SMR_TRIANGLE_CHUNK;
    const uint32_t from = b->at, to = smr_min_u32(from + chunk, length);
    (void)task;
    (void)worker;
    if (b->stage == SMR_BRAKE_LOOK)
        look(s, from, to);
    else if (b->stage == SMR_BRAKE_TOUCH)
        touch(s, part->first_triangle + from, part->first_triangle + to);
    else
        move(s, part->first_vertex + from, part->first_vertex + to);
    b->at = to;
    if (to == length)
        next_pass(s);
}
