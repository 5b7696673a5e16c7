/* case_figure.c: a trunk and four limbs of two parts each, one closed surface, and the same with all joints bent.
 * SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "case.h"
#include "fixture_net.h"

#define CELL_MM 9.0f
#define ROUND_MM 15.0f /* by which capsules grow together */
#define STEP_MM 0.05f  /* of the numeric gradient */

enum { VERTICES = 12000, NODES_X = 82, NODES_Y = 24, NODES_Z = 88 };

static const struct {
    float from[3], to[3], radius;
} capsules[] = {{{0, 0, 0}, {0, 0, 220}, 60},      {{0, -30, 60}, {0, -20, 120}, 50},
                {{75, 0, 205}, {195, 0, 205}, 24}, {{195, 0, 205}, {310, 0, 205}, 20},
                {{40, 0, -20}, {45, 0, -200}, 36}, {{45, 0, -200}, {48, 0, -390}, 27}}; /* and mirrored */

/* Joints, the far one of a limb first; all are mirrored. Vertices within zone mm along the limb bend in part. */
static const struct {
    double at[3], along[3], axis[3], zone;
} joints[] = {{{195, 0, 205}, {1, 0, 0}, {0, 0, -1}, 20},
              {{85, 0, 205}, {1, 0, 0}, {0, 1, 0}, 24},
              {{45, 0, -200}, {0, 0, -1}, {1, 0, 0}, 30},
              {{40, 0, -25}, {0, 0, -1}, {-1, 0, 0}, 36}};

static float figure_value(const void *context, const float *p)
{
    const float q[3] = {fabsf(p[0]), p[1], p[2]};
    float all = 1e9f;
    (void)context;
    for (size_t i = 0; i < sizeof capsules / sizeof capsules[0]; i++) {
        float along = 0.0f, length = 0.0f, d2 = 0.0f;
        for (int c = 0; c < 3; c++) {
            const float axis = capsules[i].to[c] - capsules[i].from[c];
            along += axis * (q[c] - capsules[i].from[c]);
            length += axis * axis;
        }
        const float t = fminf(fmaxf(along / length, 0.0f), 1.0f);
        for (int c = 0; c < 3; c++) {
            const float d = q[c] - capsules[i].from[c] - t * (capsules[i].to[c] - capsules[i].from[c]);
            d2 += d * d;
        }
        const float one = sqrtf(d2) - capsules[i].radius, near = fmaxf(ROUND_MM - fabsf(all - one), 0.0f);
        all = fminf(all, one) - near * near / (4.0f * ROUND_MM);
    }
    return all;
}

static float figure_gradient(const void *context, const float *p, float *gradient)
{
    float length = 0.0f;
    for (int c = 0; c < 3; c++) {
        float a[3] = {p[0], p[1], p[2]}, b[3] = {p[0], p[1], p[2]};
        a[c] -= STEP_MM;
        b[c] += STEP_MM;
        gradient[c] = (figure_value(context, b) - figure_value(context, a)) / (2.0f * STEP_MM);
        length += gradient[c] * gradient[c];
    }
    length = fmaxf(sqrtf(length), 1e-6f);
    for (int c = 0; c < 3; c++)
        gradient[c] /= length;
    return figure_value(context, p) / length;
}

/* Bends all joints; s rises from 0 to 1 across the zone of a joint, and the angle with it. */
static void bend_joints(host_mesh *mesh, double degrees)
{
    for (uint32_t v = 0; v < mesh->n_vertices; v++) {
        double rest[3], p[3];
        case_get(mesh, v, rest);
        const double side = rest[0] < 0.0 ? -1.0 : 1.0;
        rest[0] *= side;
        memcpy(p, rest, sizeof p);
        for (size_t j = 0; j < sizeof joints / sizeof joints[0]; j++) {
            const double d[3] = {rest[0] - joints[j].at[0], rest[1] - joints[j].at[1], rest[2] - joints[j].at[2]};
            const double t = fmin(fmax(0.5 + 0.5 * case_dot(d, joints[j].along) / joints[j].zone, 0.0), 1.0);
            double turn[9], x[3];
            if (j < 2u && rest[2] < 100.0)
                continue; /* arms */
            oracle_turn(joints[j].axis, case_radians(degrees * t * t * (3.0 - 2.0 * t)), turn);
            for (int c = 0; c < 3; c++)
                x[c] = p[c] - joints[j].at[c];
            for (int c = 0; c < 3; c++)
                p[c] = joints[j].at[c] + case_dot(turn + 3 * c, x);
        }
        p[0] *= side;
        case_put(mesh, v, p);
    }
}

/* SEED DEGREES CUT DIR: CUT 1: the upper third of the target's height is cut away. */
void case_figure(char **word)
{
    static const fixture_field field = {figure_value, figure_gradient, NULL};
    const fixture_net_grid grid = {CELL_MM, {-360.0f, -115.0f, -450.0f}, {NODES_X, NODES_Y, NODES_Z}};
    case_data *const data = case_alloc(1, sizeof *data);
    case_body *const body = &data->body[0];
    oracle_random r = oracle_seed(8000u + (uint32_t)atoi(word[0]));
    float *const scratch =
        case_alloc(FIXTURE_NET_LAYERS(NODES_X, NODES_Y) + FIXTURE_NET_EVEN(VERTICES), sizeof *scratch);
    host_mesh *const model = &body->model;
    *model = case_new_mesh(VERTICES, 2u * VERTICES);
    fixture_mesh made = {model->xyz, model->triangles, VERTICES, 2u * VERTICES, 0, 0};
    if (!fixture_net_make(&field, &grid, &made, scratch))
        case_fail("the figure has no mesh");
    fixture_net_even(&field, &made, 20, scratch);
    model->n_vertices = made.n_vertices;
    model->n_triangles = made.n_triangles;
    strcpy(body->name, "figure");
    data->n = 1;
    body->truth = case_copy(model);
    body->whole = case_subdivide(model, NULL);
    body->target = case_subdivide(model, &r);
    bend_joints(&body->truth, atof(word[1]));
    bend_joints(&body->whole, atof(word[1]));
    bend_joints(&body->target, atof(word[1]));
    if (atoi(word[2])) {
        float top = -1e9f;
        case_keep_shares(&body->target, 0.0, 2.0 / 3.0);
        for (uint32_t v = 0; v < body->target.n_vertices; v++)
            top = fmaxf(top, body->target.xyz[3u * (size_t)v + 2u]);
        body->seen = case_alloc(body->model.n_vertices, 1);
        for (uint32_t v = 0; v < body->model.n_vertices; v++)
            body->seen[v] = body->truth.xyz[3u * (size_t)v + 2u] <= top;
    }
    free(scratch);
    case_write(data, word[3]);
}
