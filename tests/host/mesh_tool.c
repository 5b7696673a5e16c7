/* mesh_tool.c: a mesh read by the host's readers, written in a format, compared with another, or timed; or a command
 * run with limits on time and memory.
 * Usage: mesh_tool convert IN FORMAT OUT | compare A B | count IN | time IN N | run MS KB COMMAND...
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#include "meshes/triangle_mesh.h"

static int read_mesh(const char *path, host_mesh *mesh)
{
    host_error error = {0};
    if (host_mesh_read(path, HOST_MESH_POINTS_TOO, HOST_MIRROR_NONE, mesh, &error) == 0)
        return 0;
    host_error_print(&error);
    return 2;
}

static int convert(const char *in, const char *format, const char *out)
{
    static const char *const names[] = {"ply", "stl", "vtk-binary", "obj", "ply-ascii", "vtk"};
    host_mesh mesh;
    host_buffer buffer = {0};
    FILE *file = NULL;
    int i = 0, result = read_mesh(in, &mesh);
    if (result != 0)
        return result;
    while (i < 5 && strcmp(format, names[i]) != 0)
        i++;
    host_mesh_write(&mesh, i, &buffer);
    file = fopen(out, "wb");
    if (file == NULL || buffer.failed || fwrite(buffer.data, 1, buffer.size, file) != buffer.size)
        result = 2;
    if (file != NULL && fclose(file) != 0)
        result = 2;
    host_buffer_free(&buffer);
    host_mesh_free(&mesh);
    return result;
}

/* 0 when both have the same vertices and triangles in the same order, to the bit. */
static int compare(const char *a, const char *b)
{
    host_mesh x, y;
    if (read_mesh(a, &x) != 0)
        return 2;
    if (read_mesh(b, &y) != 0) {
        host_mesh_free(&x);
        return 2;
    }
    int same = x.n_vertices == y.n_vertices && x.n_triangles == y.n_triangles &&
               memcmp(x.xyz, y.xyz, 12u * (size_t)x.n_vertices) == 0 &&
               (x.n_triangles == 0 || memcmp(x.triangles, y.triangles, 12u * (size_t)x.n_triangles) == 0);
    if (!same)
        printf("differ: %u/%u vertices, %u/%u triangles\n", x.n_vertices, y.n_vertices, x.n_triangles, y.n_triangles);
    host_mesh_free(&x);
    host_mesh_free(&y);
    return same ? 0 : 1;
}

/* "vertices triangles area volume": area and volume do not depend on the order. */
static int count(const char *in)
{
    host_mesh mesh;
    double area = 0.0, volume = 0.0;
    if (read_mesh(in, &mesh) != 0)
        return 2;
    for (uint32_t i = 0; i < mesh.n_triangles; i++) {
        double p[3][3], n[3];
        int k = 0;
        for (k = 0; k < 9; k++) {
            const size_t vertex = mesh.triangles[3u * (size_t)i + (size_t)(k / 3)];
            p[k / 3][k % 3] = (double)mesh.xyz[3u * vertex + (size_t)(k % 3)];
        }
        for (k = 0; k < 3; k++) {
            const int l = (k + 1) % 3, m = (k + 2) % 3;
            n[k] = (p[1][l] - p[0][l]) * (p[2][m] - p[0][m]) - (p[1][m] - p[0][m]) * (p[2][l] - p[0][l]);
        }
        area += 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        volume += (p[0][0] * n[0] + p[0][1] * n[1] + p[0][2] * n[2]) / 6.0;
    }
    printf("%u %u %.3f %.3f\n", mesh.n_vertices, mesh.n_triangles, area, volume);
    host_mesh_free(&mesh);
    return 0;
}

/* Runs a command. Returns its exit status, 98 when it took too long (processor time, or ten times as much elapsed
 * time), 97 when it took too much memory, 96 for a signal. */
static int run_limited(int most_ms, long most_kb, char **command)
{
    struct timespec a, b;
    struct rusage usage;
    int status = 0;
    (void)clock_gettime(CLOCK_MONOTONIC, &a);
    pid_t child = fork();
    if (child == 0) {
        (void)execvp(command[0], command);
        _exit(95);
    }
    if (child < 0 || waitpid(child, &status, 0) != child || getrusage(RUSAGE_CHILDREN, &usage) != 0)
        return 95;
    (void)clock_gettime(CLOCK_MONOTONIC, &b);
    double ms = (double)(b.tv_sec - a.tv_sec) * 1e3 + (double)(b.tv_nsec - a.tv_nsec) * 1e-6;
    if (!WIFEXITED(status))
        return 96;
    if (usage.ru_maxrss > most_kb)
        return 97;
    const double cpu_ms = (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) * 1e3 +
                          (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec) * 1e-3;
    return cpu_ms > most_ms || ms > 10.0 * most_ms ? 98 : WEXITSTATUS(status);
}

static int time_reading(const char *in, int n)
{
    struct timespec a, b;
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &a);
    for (int i = 0; i < n; i++) {
        host_mesh mesh;
        if (read_mesh(in, &mesh) != 0)
            return 2;
        host_mesh_free(&mesh);
    }
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &b);
    printf("%.3f ms\n", ((double)(b.tv_sec - a.tv_sec) * 1e3 + (double)(b.tv_nsec - a.tv_nsec) * 1e-6) / n);
    return 0;
}

int main(int argc, char **argv)
{
    if (argc == 5 && strcmp(argv[1], "convert") == 0)
        return convert(argv[2], argv[3], argv[4]);
    if (argc == 4 && strcmp(argv[1], "compare") == 0)
        return compare(argv[2], argv[3]);
    if (argc == 3 && strcmp(argv[1], "count") == 0)
        return count(argv[2]);
    if (argc == 4 && strcmp(argv[1], "time") == 0 && atoi(argv[3]) > 0)
        return time_reading(argv[2], atoi(argv[3]));
    if (argc >= 5 && strcmp(argv[1], "run") == 0)
        return run_limited(atoi(argv[2]), atol(argv[3]), argv + 4);
    (void)fputs("usage: mesh_tool convert IN FORMAT OUT | compare A B | count IN | time IN N | run MS KB COMMAND...\n",
                stderr);
    return 2;
}
