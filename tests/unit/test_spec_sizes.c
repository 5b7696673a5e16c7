/* test_spec_sizes.c: sizes that docs/SPEC.md states, measured through the public API. Vertices and triangles in
 * numbers that are multiples of 64 leave no room between slots: differences of sizes are exact. A number with
 * decimals is compared as rounded to them. The test prints what it measures, so that a changed layout costs one edit
 * of the table.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "base/bytes.h"
#include "geometry/surface/surface.h"
#include "smr.h"

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define RED_ZONES 1
#endif
#elif defined(__SANITIZE_ADDRESS__)
#define RED_ZONES 1
#endif

enum { N = 4096, GRID = 64, FEW = 512, MANY = 4096, SECTION = 65536 };

static char spec[SECTION];                               /* the arena's and the surface's tables */
static int misses;                                       /* all are told, not the first alone */
static uint32_t n_landmarks, caller_goals, caller_force; /* of the next arena's configuration */
static float volume, smooth;
static uint32_t n_shapes; /* of further subjects, of the next model */
static uint32_t contact, n_fixed;

/* A section of the document; its tables are for 64-bit hosts without room between slots. */
static const char *begin(const char *heading)
{
    const char *const section = strstr(spec, heading);
    misses = 0;
#ifdef RED_ZONES
    skip();
#endif
    if (sizeof(void *) != 8)
        skip();
    assert_non_null(section);
    return section;
}

/* A number such as 2,112 or 27.4. */
static double number(const char *at)
{
    double value = 0.0, digit = 1.0;
    for (; *at == ' '; at++) {
    }
    for (; (*at >= '0' && *at <= '9') || *at == ','; at++)
        value = *at == ',' ? value : 10.0 * value + (*at - '0');
    if (*at == '.')
        for (at++; *at >= '0' && *at <= '9'; at++)
            value += (digit /= 10.0) * (*at - '0');
    return value;
}

/* The number behind a piece of a sentence. */
static double stated(const char *section, const char *text)
{
    const char *const at = strstr(section, text);
    assert_non_null(at);
    return number(at + strlen(text));
}

/* Sum of the rows "| unit | bytes |" of a section's first table. */
static double rows(const char *section, const char *unit)
{
    const char *at = strstr(section, "| for each");
    const char *const end = at != NULL ? strstr(at, "\n\n") : NULL;
    double sum = 0.0;
    char row[64];
    assert_non_null(end);
    (void)snprintf(row, sizeof row, "\n| %s |", unit);
    while ((at = strstr(at, row)) != NULL && at < end) {
        at += strlen(row);
        sum += number(at);
    }
    return sum;
}

static int read_spec(void **state)
{
    FILE *const file = fopen("docs/SPEC.md", "rb");
    char line[4096];
    size_t n = 0;
    int on = 0;
    (void)state;
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        on = strncmp(line, "## ", 3) == 0 ? strcmp(line, "## 3. Memory\n") == 0 : on;
        if (on && n + strlen(line) + 1u < sizeof spec) {
            memcpy(spec + n, line, strlen(line) + 1u);
            n += strlen(line);
        }
    }
    return file != NULL && fclose(file) == 0 && n > 0 ? 0 : -1;
}

/* The first nt triangles of a grid with GRID vertices in a row, two in each square. */
static uint32_t *grid(uint32_t nt)
{
    uint32_t *const triangle = test_malloc(sizeof(uint32_t) * 3u * (nt + 1u));
    for (uint32_t k = 0; k < nt; k++) {
        const uint32_t square = k / 2u, corner = square / (GRID - 1u) * GRID + square % (GRID - 1u);
        triangle[3u * k] = k % 2u ? corner + 1u : corner;
        triangle[3u * k + 1u] = k % 2u ? corner + GRID + 1u : corner + 1u;
        triangle[3u * k + 2u] = corner + GRID;
    }
    return triangle;
}

/* The arena of such a model. */
static double arena_of(const smr_structure *structure, uint32_t ns, const smr_config *config)
{
    smr_prepare_config prepare = smr_prepare_config_default();
    const smr_model *model = NULL;
    size_t bytes = 0, scratch_bytes = 0, arena_bytes = 0;
    prepare.n_radii = 1;
    prepare.radius_mm[0] = 12.0f;
    const smr_subjects also = {structure->mesh.xyz, n_shapes};
    prepare.also = &also;
    assert_int_equal(smr_prepare_bytes(structure, ns, &prepare, &scratch_bytes), SMR_OK);
    void *const scratch = aligned_alloc(SMR_ALIGN, (scratch_bytes + 63u) & ~(size_t)63u);
    assert_non_null(scratch);
    assert_int_equal(smr_prepare(structure, ns, &prepare, scratch, scratch_bytes, NULL, 0, &bytes), SMR_OK);
    void *const memory = aligned_alloc(SMR_ALIGN, (bytes + 63u) & ~(size_t)63u);
    assert_non_null(memory);
    assert_int_equal(smr_prepare(structure, ns, &prepare, scratch, scratch_bytes, memory, bytes, &bytes), SMR_OK);
    assert_int_equal(smr_model_open(memory, bytes, &model), SMR_OK);
    assert_int_equal(smr_arena_bytes(model, config, &arena_bytes), SMR_OK);
    free(memory);
    free(scratch);
    return (double)arena_bytes;
}

/* The arena of n vertices in ns structures, with nt triangles in each. */
static double arena_with(uint32_t nt, uint32_t n, uint32_t ns, uint32_t method, uint32_t targets, uint32_t workers)
{
    static smr_structure structure[128];
    static char name[128][8];
    smr_config config = smr_config_default();
    float *const xyz = test_malloc(sizeof(float) * 3u * n);
    uint32_t *const triangle = grid(nt);
    for (uint32_t i = 0; i < n; i++) {
        xyz[3u * i] = 10.0f * (float)(i % GRID);
        xyz[3u * i + 1u] = 10.0f * (float)(i / GRID);
        xyz[3u * i + 2u] = 0.0f;
    }
    memset(structure, 0, sizeof structure);
    for (uint32_t k = 0; k < ns; k++) {
        (void)snprintf(name[k], sizeof name[k], "s%u", (unsigned)k);
        structure[k].name = name[k];
        structure[k].mesh.xyz = xyz + (size_t)3u * (n / ns) * k;
        structure[k].mesh.n_vertices = n / ns;
        structure[k].mesh.triangles = nt > 0u ? triangle : NULL;
        structure[k].mesh.n_triangles = nt;
    }
    config.basic.method = method;
    config.basic.n_target_vertices = targets;
    config.basic.n_workers = workers;
    config.partial.n_landmarks = n_landmarks;
    config.caller.goals = caller_goals;
    config.caller.force = caller_force;
    config.contact.volume = volume;
    config.contact.smooth = smooth;
    config.contact.share = (float)contact;
    config.contact.n_fixed = n_fixed;
    const double bytes = arena_of(structure, ns, &config);
    test_free(triangle);
    test_free(xyz);
    return bytes;
}

/* The same without triangles. */
static double arena(uint32_t n, uint32_t ns, uint32_t method, uint32_t targets, uint32_t workers)
{
    return arena_with(0, n, ns, method, targets, workers);
}

/* To so many units of 1 / parts. */
static double rounded(double value, double parts) { return (double)(long)(value * parts + 0.5) / parts; }

static void agrees(const char *what, double measured, double said)
{
    (void)printf("%-44s measured %10.2f   docs/SPEC.md %10.2f\n", what, measured, said);
    (void)fflush(stdout);
    misses += !(measured > said - 0.005 && measured < said + 0.005);
}

TEST(arena_is_as_stated)
{
    const char *const section = begin("### Arena");
    const double least = arena(N, 1, SMR_METHOD_RIGID, 0, 1);
    const double vertex = (arena(2 * N, 1, SMR_METHOD_RIGID, 0, 1) - least) / N;
    const double polar = (arena(2 * N, 1, SMR_METHOD_POLAR, 0, 1) - arena(N, 1, SMR_METHOD_POLAR, 0, 1)) / N;
    const double many = arena(N, 64, SMR_METHOD_RIGID, 0, 1);
    const double structure = (arena(N, 128, SMR_METHOD_RIGID, 0, 1) - many) / 64.0;
    const double place = arena(N, 1, SMR_METHOD_RIGID, 0, 2) - least;
    const double worker = (arena(N, 1, SMR_METHOD_RIGID, 64, 2) - arena(N, 1, SMR_METHOD_RIGID, 64, 1) - place) / N;
    const double tally = rows(section, "32 vertices, a tally") / 32.0;
    agrees("a vertex, rigid", vertex - tally, stated(section, "In all a vertex takes"));
    agrees("a vertex, the table's rows", vertex - tally, rows(section, "vertex"));
    agrees("a vertex, polar", polar - tally, stated(section, "of the arena (rigid) or"));
    agrees("a vertex more with polar, the table's row", polar - vertex, rows(section, "vertex, polar"));
    agrees("a structure", structure, rows(section, "structure"));
    agrees("a worker", place, rows(section, "worker"));
    agrees("a worker and vertex", worker, rows(section, "vertex and worker"));
    agrees("a worker and vertex, in the sentence", worker, stated(section, "and each worker"));
    agrees("a registration, to the next 64 bytes", many - N * vertex - 64.0 * structure - place,
           64.0 * (double)(int)((rows(section, "registration") + 63.0) / 64.0));
    assert_int_equal(misses, 0);
}

/* What only a setting takes. */
TEST(settings_are_as_stated)
{
    const char *const section = begin("### Arena");
    const double least = arena(N, 64, SMR_METHOD_RIGID, 0, 1);
    n_landmarks = 64;
    const double marked = arena(N, 64, SMR_METHOD_RIGID, 0, 1) - least;
    agrees("64 landmarks, and a byte for each vertex", marked,
           64.0 * rows(section, "landmark") + N * rows(section, "vertex, landmarks"));
    n_landmarks = 0;
    caller_goals = 1;
    agrees("goals of the caller's", (arena(N, 64, SMR_METHOD_RIGID, 0, 1) - least) / 64.0,
           rows(section, "structure, caller's goals"));
    caller_goals = 0;
    caller_force = SMR_CALLER_ON;
    agrees("a force of the caller's", (arena(N, 64, SMR_METHOD_RIGID, 0, 1) - least) / N,
           rows(section, "vertex, caller's force"));
    caller_force = SMR_CALLER_OFF;
    volume = 1.0f;
    agrees("volumes that are kept", (arena(N, 64, SMR_METHOD_RIGID, 0, 1) - least) / 64.0,
           rows(section, "structure, volume"));
    volume = 0.0f;
    smooth = 1.0f;
    agrees("smoothing", (arena(N, 64, SMR_METHOD_RIGID, 0, 1) - least) / N, rows(section, "vertex, smoothing"));
    smooth = 0.0f;
    n_shapes = 1;
    agrees("a shape of a further subject", arena(N, 64, SMR_METHOD_RIGID, 0, 1) - least,
           rows(section, "registration, references"));
    n_shapes = 0;
    n_fixed = 64;
    agrees("64 fixed surfaces", arena(N, 64, SMR_METHOD_RIGID, 0, 1) - least, 64.0 * rows(section, "fixed surface"));
    n_fixed = 0;
    contact = 1;
    agrees("contact", arena(N, 64, SMR_METHOD_RIGID, 0, 1) - least,
           N * rows(section, "vertex, contact") + 64.0 * rows(section, "structure, contact"));
    agrees("a triangle's touch",
           rounded((arena_with(MANY, N, 1, SMR_METHOD_RIGID, N, 1) - arena_with(FEW, N, 1, SMR_METHOD_RIGID, N, 1)) /
                           (MANY - FEW) -
                       rows(section, "triangle") - rows(section, "triangle, targets"),
                   1.0),
           rows(section, "triangle, contact"));
    contact = 0;
    assert_int_equal(misses, 0);
}

TEST(triangles_are_as_stated)
{
    const char *const section = begin("### Arena");
    const double few = arena_with(FEW, N, 1, SMR_METHOD_RIGID, 0, 1);
    const double many = arena_with(MANY, N, 1, SMR_METHOD_RIGID, 0, 1);
    const double few_targets = arena_with(FEW, N, 1, SMR_METHOD_RIGID, N, 1);
    const double many_targets = arena_with(MANY, N, 1, SMR_METHOD_RIGID, N, 1);
    const double more_targets = arena_with(MANY, N, 1, SMR_METHOD_RIGID, 2 * N, 1);
    const double triangle = (many - few) / (MANY - FEW), with_targets = (many_targets - few_targets) / (MANY - FEW);
    const double big_endian = SMR_BIG_ENDIAN ? rows(section, "triangle, big-endian") : 0.0;
    agrees("a triangle", triangle, rows(section, "triangle") + big_endian);
    agrees("a triangle's tree, with targets", rounded(with_targets - triangle, 10.0),
           rows(section, "triangle, targets"));
    agrees("two triangles, with targets", rounded(2.0 * (with_targets - big_endian), 1.0),
           stated(section, "two triangles add"));
    agrees("a target vertex", (more_targets - many_targets) / N, rows(section, "target vertex"));
    assert_int_equal(misses, 0);
}

static double surface(uint32_t n_vertices, uint32_t n_triangles)
{
    size_t bytes = 0;
    assert_int_equal(smr_surface_bytes(n_vertices, n_triangles, &bytes), SMR_OK);
    return (double)bytes;
}

TEST(surface_is_as_stated)
{
    const char *const section = begin("### Target surface");
    const double least = surface(N, 2 * N);
    agrees("a surface's vertex", (surface(2 * N, 64 * N) - surface(N, 64 * N)) / N, rows(section, "vertex"));
    agrees("a surface's triangle", rounded((surface(N, 64 * N) - least) / (62.0 * N), 10.0), rows(section, "triangle"));
    agrees("a surface itself", (double)sizeof(struct smr_surface), rows(section, "surface"));
    assert_int_equal(misses, 0);
}

int main(void) { return suite_run(read_spec, NULL); }
