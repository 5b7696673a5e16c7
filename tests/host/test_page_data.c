/* test_page_data.c: the data of a page: base64, JSON in a script element, 16-bit numbers, thinned surfaces, the cut of
 * an image.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "html/page_data.h"

/* What a writer of JSON adds, without the bracket around it. */
static char *written(host_buffer *out)
{
    assert_int_equal(out->failed, 0);
    host_buffer_add(out, "", 1);
    return (char *)out->data + 1;
}

TEST(base64_is_the_standard_one)
{
    static const char *const pairs[][2] = {{"", ""},        {"f", "Zg=="},          {"fo", "Zm8="},
                                           {"foo", "Zm9v"}, {"foobar", "Zm9vYmFy"}, {"\xff\xfe\xfd", "//79"}};
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        host_buffer out = {0};
        host_json json = {&out, 0, 1, 1};
        char text[32];
        host_json_open(&json, NULL, '[');
        host_page_bytes(&json, NULL, pairs[i][0], strlen(pairs[i][0]));
        (void)snprintf(text, sizeof text, "\"%s\"", pairs[i][1]);
        assert_string_equal(written(&out), text);
        host_buffer_free(&out);
    }
}

TEST(data_cannot_end_their_element)
{
    static const char *const pairs[][2] = {
        {"{\n  \"a b\": [1,\n  2]\n}\n", "{\"a b\":[1,2]}"},
        {"\"</script><!-- & -->\"", "\"\\u003c/script>\\u003c!-- & -->\""},
        {"\"\\\" x\\\\\" : 1", "\"\\\" x\\\\\":1"},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        host_buffer json = {0}, out = {0};
        host_buffer_add(&json, pairs[i][0], strlen(pairs[i][0]));
        host_page_write(&json, &out);
        assert_non_null(strstr(written(&out), pairs[i][1]));
        host_buffer_free(&json);
        host_buffer_free(&out);
    }
}

/* The 16-bit numbers in base64 behind the last "at". */
static uint32_t word(const char *json, size_t i)
{
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const char *const at = strstr(json, "\"at\": \"");
    uint32_t bytes[2] = {0, 0};
    assert_non_null(at);
    for (size_t k = 0; k < 2; k++) {
        const size_t byte = 2u * i + k, bit = 8u * byte;
        const char *const c = at + 7 + bit / 6u;
        const uint32_t both = (uint32_t)(strchr(digit, c[0]) - digit) << 6 | (uint32_t)(strchr(digit, c[1]) - digit);
        bytes[k] = both >> (4u - bit % 6u) & 255u;
    }
    return bytes[0] | bytes[1] << 8;
}

TEST(values_keep_what_they_are)
{
    static const uint32_t all[] = {0, 1, 2, 3, 4, 5, 6};
    const float value[] = {0.0f, 3.0f, 12.5f, NAN, -1.0f, INFINITY, 0.001f}, none[] = {NAN, -1.0f},
                zero[] = {0.0f, 0.0f};
    host_buffer out = {0};
    host_json json = {&out, 0, 1, 1};
    host_page_values(&json, NULL, value, all, 7);
    const char *text = written(&out) - 1;
    const double unit = atof(strstr(text, "unit\": ") + 7);
    assert_int_equal(word(text, 0), 0);
    assert_true(fabs(unit * word(text, 1) - 3.0) <= unit);
    assert_true(fabs(unit * word(text, 2) - 12.5) <= unit);
    assert_int_equal(word(text, 2), 65534);
    for (size_t i = 3; i < 6; i++)
        assert_int_equal(word(text, i), 65535);
    assert_true(fabs(unit * word(text, 6) - 0.001) <= unit);
    for (size_t i = 0; i < 2; i++) {
        out.size = 0;
        host_page_values(&json, NULL, i == 0 ? none : zero, all, 2);
        text = written(&out) - 1;
        assert_true(atof(strstr(text, "unit\": ") + 7) > 0.0);
        assert_int_equal(word(text, 1), i == 0 ? 65535 : 0);
    }
    host_buffer_free(&out);
}

TEST(points_keep_their_places)
{
    const float xyz[] = {-10, 5, 0, 90, 5, 0, 40, 5, 1000};
    const uint32_t keep[] = {2, 0};
    host_buffer out = {0};
    host_json json = {&out, 0, 1, 1};
    host_page_points(&json, NULL, xyz, NULL, 3);
    const char *text = written(&out) - 1;
    assert_non_null(strstr(text, "{\"low\": [-10, 5, 0], \"high\": [90, 5, 1000], \"at\": \""));
    assert_int_equal(word(text, 0), 0);
    assert_int_equal(word(text, 3), 65535);
    assert_true(fabs(word(text, 6) / 65535.0 * 100.0 - 50.0) < 0.01);
    assert_int_equal(word(text, 1), 0); /* a flat side */
    out.size = 0;
    host_page_points(&json, NULL, xyz, keep, 2);
    text = written(&out) - 1;
    assert_non_null(strstr(text, "\"low\": [-10, 5, 0], \"high\": [40, 5, 1000]"));
    assert_int_equal(word(text, 2), 65535);
    host_buffer_free(&out);
}

enum { SIDE = 20 };

/* A flat square of SIDE x SIDE cells of 1 mm. */
static host_mesh make_sheet(void)
{
    host_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    mesh.n_vertices = (SIDE + 1) * (SIDE + 1);
    mesh.xyz = calloc(3u * mesh.n_vertices, sizeof *mesh.xyz);
    mesh.triangles = calloc(6u * SIDE * SIDE, sizeof *mesh.triangles);
    assert_non_null(mesh.xyz);
    assert_non_null(mesh.triangles);
    for (uint32_t i = 0; i < mesh.n_vertices; i++) {
        mesh.xyz[3u * i] = (float)(i % (SIDE + 1)) - 7.0f;
        mesh.xyz[3u * i + 1u] = (float)(i / (SIDE + 1));
    }
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        const uint32_t a = i / SIDE * (SIDE + 1) + i % SIDE,
                       cell[6] = {a, a + 1, a + SIDE + 1, a + SIDE + 2, a + SIDE + 1, a + 1};
        for (uint32_t k = 0; k < 6; k++)
            mesh.triangles[6u * i + k] = cell[k];
    }
    mesh.n_triangles = 2 * SIDE * SIDE;
    return mesh;
}

TEST(thinning_leaves_a_surface)
{
    host_mesh mesh = make_sheet();
    host_page_mesh thin;
    assert_int_equal(host_page_thin(&mesh, 0.0f, &thin), 0);
    assert_int_equal(thin.n_vertices, mesh.n_vertices);
    assert_int_equal(thin.n_triangles, mesh.n_triangles);
    assert_memory_equal(thin.triangles, mesh.triangles, 12u * mesh.n_triangles);
    host_page_mesh_free(&thin);
    assert_int_equal(host_page_thin(&mesh, 4.0f, &thin), 0);
    assert_true(thin.n_vertices >= 25 && thin.n_vertices <= 42); /* cubes of 4 mm over 20 mm */
    assert_true(thin.n_triangles >= 30 && thin.n_triangles < 100);
    for (uint32_t i = 0; i < 3u * thin.n_triangles; i++)
        assert_true(thin.triangles[i] < thin.n_vertices);
    for (uint32_t i = 0; i < thin.n_triangles; i++)
        assert_true(thin.triangles[3u * i] != thin.triangles[3u * i + 1u] &&
                    thin.triangles[3u * i] != thin.triangles[3u * i + 2u]);
    for (uint32_t i = 1; i < thin.n_vertices; i++)
        assert_true(thin.keep[i] > thin.keep[i - 1u]);
    host_page_mesh_free(&thin);
    host_mesh_free(&mesh);
}

TEST(all_are_thinned_alike)
{
    host_mesh mesh = make_sheet();
    host_page_part *const part = calloc(2, sizeof *part);
    float cell = -1.0f;
    assert_non_null(part);
    part[0].mesh = part[1].mesh = &mesh;
    part[0].vertex_bytes = 18;
    assert_int_equal(host_page_thin_all(part, 2, SIZE_MAX, SIZE_MAX, &cell), 0);
    assert_true(cell <= 0.0f && part[1].thin.n_vertices == mesh.n_vertices);
    assert_int_equal(host_page_thin_all(part, 2, 300, SIZE_MAX, &cell), 0);
    assert_true(cell > 1.0f && part[0].thin.n_vertices == part[1].thin.n_vertices && part[0].thin.n_vertices <= 150 &&
                part[0].thin.n_vertices > 50);
    assert_int_equal(host_page_thin_all(part, 2, SIZE_MAX, 2000, &cell), 0);
    assert_true(18u * part[0].thin.n_vertices + 6u * (part[0].thin.n_triangles + part[1].thin.n_triangles) <= 2000u);
    host_page_parts_free(part, 2);
    host_mesh_free(&mesh);
}

enum { NX = 12, NY = 10, NZ = 8 };

/* Brightness rises linearly: what is cut out of it and averaged must as well, to a tenth of a voxel: a voxel counts as
 * far as it is covered. */
TEST(image_is_cut_and_averaged)
{
    uint16_t voxel[NX * NY * NZ];
    host_volume v = {voxel, SMR_VOXEL_UINT16, {NX, NY, NZ}, {100, -50, 30}, {1, 1, 3}, {0, 1, 0, 1, 0, 0, 0, 0, -1}};
    const host_box box = {{101, -49, 15}, {106, -44, 20}, 2}, away = {{500, 500, 500}, {510, 510, 510}, 2};
    host_page_image out;
    uint32_t i = 0, at[3];
    for (i = 0; i < NX * NY * NZ; i++)
        voxel[i] = (uint16_t)(1000 + 10 * (i % NX) + 100 * (i / NX % NY) + 20 * (i / NX / NY));
    assert_int_equal(host_page_image_make(&v, &away, 5, 1000, &out), 0);
    assert_null(out.at);
    assert_int_equal(host_page_image_make(&v, &box, 1000, NX * NY * NZ, &out), 0);
    assert_true(out.size[0] == NX && out.size[1] == NY && out.size[2] == NZ);
    free(out.at);
    assert_int_equal(host_page_image_make(&v, &box, 1, 150, &out), 0);
    assert_true(out.size[0] * out.size[1] * out.size[2] <= 150 && out.size[0] >= 3 && out.size[0] <= 8);
    assert_true(out.spacing[0] > 1.0f && out.spacing[0] < 2.0f && fabsf(out.spacing[2] - 3.0f) < 1e-6f);
    for (at[2] = 0, i = 0; at[2] < out.size[2]; at[2]++)
        for (at[1] = 0; at[1] < out.size[1]; at[1]++)
            for (at[0] = 0; at[0] < out.size[0]; at[0]++, i++) {
                double p[3], want = 1000.0;
                int c = 0;
                for (c = 0; c < 3; c++)
                    p[c] = (double)out.first[c] + (double)(v.direction[3 * c]) * at[0] * (double)out.spacing[0] +
                           (double)(v.direction[3 * c + 1]) * at[1] * (double)out.spacing[1] +
                           (double)(v.direction[3 * c + 2]) * at[2] * (double)out.spacing[2];
                want += 10.0 * (p[1] + 50.0) + 100.0 * (p[0] - 100.0) + 20.0 * (30.0 - p[2]) / 3.0;
                want = fmin(out.high, fmax(out.low, want));
                assert_true(fabs(out.low + out.at[i] / 255.0 * (out.high - out.low) - want) < 12.0);
            }
    assert_true(out.low >= 1000.0 && out.high <= 2200.0 && out.high > out.low + 300.0);
    free(out.at);
}

TEST(odd_images_are_no_trouble)
{
    float value[8] = {NAN, INFINITY, -INFINITY, 5, 5, 5, 5, NAN};
    uint8_t one = 7;
    host_volume v = {value, SMR_VOXEL_FLOAT, {2, 2, 2}, {0, 0, 0}, {1, 1, 1}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    const host_box box = {{-1, -1, -1}, {3, 3, 3}, 2};
    host_page_image out;
    assert_int_equal(host_page_image_make(&v, &box, 10, 100, &out), 0);
    assert_true(isfinite(out.low) && out.high > out.low);
    free(out.at);
    assert_int_equal(host_page_image_make(&v, &box, 10, 1, &out), 0);
    assert_int_equal(out.size[0] * out.size[1] * out.size[2], 1);
    free(out.at);
    value[3] = -3e38f;
    value[4] = 3e38f;
    assert_int_equal(host_page_image_make(&v, &box, 10, 100, &out), 0);
    assert_true(isfinite(out.low) && out.high > out.low);
    free(out.at);
    v = (host_volume){&one, SMR_VOXEL_UINT8, {1, 1, 1}, {0, 0, 0}, {1, 1, 1}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    assert_int_equal(host_page_image_make(&v, &box, 10, 100, &out), 0);
    assert_int_equal(out.at[0], 7);
    free(out.at);
}
