/* summary_picture.c: draws the surfaces of a result, seen from the front: x to the right, z up, with hidden surfaces
 * removed, in few shades. Rows of like pixels become SVG lines. Structures whose verdict is not good are hatched, so
 * that they show in black and white, too.
 * SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cohort/report_path.h"
#include "cohort/summary_table.h"
#include "meshes/triangle_mesh.h"

enum { WIDE = 96, HIGH = 160, SHADES = 5, INK = SHADES, TONES = 6 };
#define VERTICES_MOST 8000000u /* of a result; further structures are left out */
#define PIXELS_MOST 200000000u /* looked at for one picture; what would come then is left out */
#define EMPTY 0xffffu

typedef struct picture {
    float depth[HIGH][WIDE];   /* mm; the nearest */
    uint16_t part[HIGH][WIDE]; /* the structure seen there, or EMPTY */
    unsigned char tone[HIGH][WIDE];
    double low[3], high[3]; /* mm, of all structures */
    double scale;           /* pixels per mm */
    uint64_t pixels;        /* looked at so far */
    host_mesh *mesh;        /* [n]; owned */
    uint32_t n;
} picture;

static void add_box(picture *p, const host_mesh *mesh)
{
    uint32_t i = 0;
    int c = 0;
    for (i = 0; i < mesh->n_vertices; i++)
        for (c = 0; c < 3; c++) {
            const double x = (double)mesh->xyz[3u * (size_t)i + (size_t)c];
            p->low[c] = x < p->low[c] ? x : p->low[c];
            p->high[c] = x > p->high[c] ? x : p->high[c];
        }
}

/* A structure's surface, whatever format it was written in. 0, or -1 when there is none that can be read. */
static int read_surface(const host_case *c, uint32_t part, host_mesh *mesh)
{
    static const char *const extensions[] = {"ply", "vtk", "obj", "stl"};
    size_t i = 0;
    for (i = 0; i < sizeof extensions / sizeof extensions[0]; i++) {
        char name[SMR_NAME_BYTES + 8u];
        char *path = NULL;
        host_error error;
        int there = 0;
        memset(&error, 0, sizeof error);
        (void)snprintf(name, sizeof name, "%s.%s", c->head.part[part].name, extensions[i]);
        path = host_report_beside(c->path, name);
        there = path != NULL && host_report_there(path) &&
                host_mesh_read(path, HOST_MESH_SURFACE, HOST_MIRROR_NONE, mesh, &error) == 0;
        free(path);
        if (there)
            return 0;
    }
    return -1;
}

/* What cannot be read is left out: the table says what the report says. */
static int read_surfaces(picture *p, const host_case *c)
{
    uint64_t vertices = 0;
    uint32_t i = 0;
    p->n = c->head.n_parts;
    p->mesh = calloc((size_t)p->n + 1u, sizeof *p->mesh);
    if (p->mesh == NULL)
        return -1;
    for (i = 0; i < p->n && vertices < VERTICES_MOST; i++) {
        if (read_surface(c, i, &p->mesh[i]) == 0)
            add_box(p, &p->mesh[i]);
        vertices += p->mesh[i].n_vertices;
    }
    return 0;
}

/* Places of a triangle's corners in the picture: columns, rows, depth. */
static void project(const picture *p, const host_mesh *mesh, uint32_t triangle, double at[3][3])
{
    int k = 0;
    for (k = 0; k < 3; k++) {
        const float *const v = mesh->xyz + 3u * (size_t)mesh->triangles[3u * (size_t)triangle + (size_t)k];
        at[k][0] = 0.5 * WIDE + p->scale * ((double)v[0] - 0.5 * (p->low[0] + p->high[0]));
        at[k][1] = 0.5 * HIGH - p->scale * ((double)v[2] - 0.5 * (p->low[2] + p->high[2]));
        at[k][2] = (double)v[1] - p->low[1];
    }
}

/* Light from the upper left behind the viewer, on either side of the triangle. */
static unsigned char shade(const picture *p, const double a[3], const double b[3], const double c[3])
{
    const double s = p->scale, ux = b[0] - a[0], uy = b[1] - a[1], uz = s * (b[2] - a[2]), vx = c[0] - a[0],
                 vy = c[1] - a[1], vz = s * (c[2] - a[2]);
    double nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    const double length = sqrt(nx * nx + ny * ny + nz * nz), turn = nz > 0.0 ? -1.0 : 1.0;
    double light = 0.0;
    if (!(length > 0.0))
        return 0;
    nx *= turn / length;
    ny *= turn / length;
    nz *= turn / length;
    light = -0.45 * nx - 0.45 * ny - 0.77 * nz;
    light = light < 0.0 ? 0.0 : light;
    return (unsigned char)(light >= 0.999 ? SHADES - 1 : (int)(light * SHADES));
}

static int clamped(double x, int most) { return x < 0.0 ? 0 : x >= (double)most ? most - 1 : (int)x; }

static double lowest(double a, double b, double c) { return fmin(a, fmin(b, c)); }

static double edge(const double a[3], const double b[3], double x, double y)
{
    return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
}

/* Draws where the middle of a pixel lies within the triangle. */
static void draw(picture *p, uint16_t part, double at[3][3])
{
    const double *const a = at[0], *const b = at[1], *const c = at[2];
    const double area = edge(a, b, c[0], c[1]);
    const int x1 = clamped(-lowest(-a[0], -b[0], -c[0]), WIDE), y1 = clamped(-lowest(-a[1], -b[1], -c[1]), HIGH);
    const int x0 = clamped(lowest(a[0], b[0], c[0]) - 0.5, WIDE), y0 = clamped(lowest(a[1], b[1], c[1]) - 0.5, HIGH);
    const unsigned char tone = shade(p, a, b, c);
    int x = 0, y = 0;
    p->pixels += (uint64_t)(x1 - x0 + 1) * (uint64_t)(y1 - y0 + 1);
    if (!(fabs(area) > 0.0) || p->pixels > PIXELS_MOST)
        return;
    for (y = y0; y <= y1; y++)
        for (x = x0; x <= x1; x++) {
            const double px = x + 0.5, py = y + 0.5;
            const double u = edge(b, c, px, py) / area, v = edge(c, a, px, py) / area, w = 1.0 - u - v;
            const float depth = (float)(u * a[2] + v * b[2] + w * c[2]);
            if (u < 0.0 || v < 0.0 || w < 0.0 || (p->part[y][x] != EMPTY && !(depth < p->depth[y][x])))
                continue;
            p->depth[y][x] = depth;
            p->part[y][x] = part;
            p->tone[y][x] = tone;
        }
}

static void draw_all(picture *p)
{
    const double wide = p->high[0] - p->low[0], high = p->high[2] - p->low[2];
    uint32_t i = 0, k = 0;
    double at[3][3];
    memset(p->part, 0xff, sizeof p->part);
    p->scale = fmin((WIDE - 4) / fmax(wide, 1e-3), (HIGH - 4) / fmax(high, 1e-3));
    for (i = 0; i < p->n; i++)
        for (k = 0; k < p->mesh[i].n_triangles && p->pixels <= PIXELS_MOST; k++) {
            project(p, &p->mesh[i], k, at);
            draw(p, (uint16_t)i, at);
        }
}

/* Lines between structures and around them, and those that mark what is not good. */
static void add_ink(picture *p, const host_case *c)
{
    int x = 0, y = 0;
    for (y = 0; y < HIGH; y++)
        for (x = 0; x < WIDE; x++) {
            const uint16_t part = p->part[y][x];
            const uint16_t right = x + 1 < WIDE ? p->part[y][x + 1] : EMPTY;
            const uint16_t below = y + 1 < HIGH ? p->part[y + 1][x] : EMPTY;
            const uint16_t left = x > 0 ? p->part[y][x - 1] : EMPTY, above = y > 0 ? p->part[y - 1][x] : EMPTY;
            const int level = part != EMPTY ? c->head.part[part].level : HOST_VERDICT_GOOD;
            if (part == EMPTY)
                continue;
            if (right != part || below != part || left == EMPTY || above == EMPTY ||
                (level == HOST_VERDICT_FAILED && (x + y) % 3 == 0) || (level == HOST_VERDICT_LOOK && (x + y) % 6 == 0))
                p->tone[y][x] = INK;
        }
}

/* One path for each tone: all its rows. */
static void write_rows(const picture *p, host_buffer *out)
{
    int tone = 0, x = 0, y = 0;
    for (tone = 0; tone < TONES; tone++) {
        host_buffer_print(out, "<path class=\"t%d\" d=\"", tone);
        for (y = 0; y < HIGH; y++)
            for (x = 0; x < WIDE; x++) {
                const int start = x;
                while (x < WIDE && p->part[y][x] != EMPTY && p->tone[y][x] == tone)
                    x++;
                if (x > start)
                    host_buffer_print(out, "M%d %dh%d", start, y, x - start);
            }
        host_buffer_print(out, "\"/>");
    }
}

int host_summary_picture(const host_case *c, host_buffer *out)
{
    picture *const p = calloc(1, sizeof *p);
    uint32_t i = 0;
    int result = 0;
    if (p == NULL)
        return -1;
    for (i = 0; i < 3; i++) {
        p->low[i] = HUGE_VAL;
        p->high[i] = -HUGE_VAL;
    }
    result = read_surfaces(p, c);
    if (result == 0 && p->low[0] <= p->high[0]) {
        draw_all(p);
        add_ink(p, c);
        host_buffer_print(out, "<svg viewBox=\"0 -0.5 %d %d\" role=\"img\" aria-label=\"the surfaces from the front\">",
                          WIDE, HIGH);
        write_rows(p, out);
        host_buffer_print(out, "</svg>");
    }
    for (i = 0; p->mesh != NULL && i < p->n; i++)
        host_mesh_free(&p->mesh[i]);
    free(p->mesh);
    free(p);
    return result;
}
