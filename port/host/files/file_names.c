/* file_names.c: names and kinds of files.
 * SPDX-License-Identifier: MIT */
#define _XOPEN_SOURCE 700
#define _POSIX_C_SOURCE 200809L

#include "files/file_names.h"
#include <dirent.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char lower(char c) { return (c >= 'A' && c <= 'Z') ? (char)(c - 'A' + 'a') : c; }

static int ends_with(const char *text, size_t n, const char *end)
{
    const size_t k = strlen(end);
    if (n < k)
        return 0;
    for (size_t i = 0; i < k; i++)
        if (lower(text[n - k + i]) != end[i])
            return 0;
    return 1;
}

int host_is_packed_name(const char *path) { return ends_with(path, strlen(path), ".gz"); }

/* Length of the path without ".gz". */
static size_t unpacked_length(const char *path) { return strlen(path) - (host_is_packed_name(path) ? 3u : 0u); }

int host_has_extension(const char *path, const char *end) { return ends_with(path, unpacked_length(path), end); }

size_t host_base_name(const char *path, char *name, size_t bytes)
{
    const char *const slash = strrchr(path, '/');
    const char *const start = slash != NULL ? slash + 1 : path;
    size_t n = unpacked_length(path) - (size_t)(start - path);
    size_t i = n, copied = 0;
    while (i > 1 && start[i - 1u] != '.')
        i--;
    if (i > 1) /* a dot that is not the first character starts the extension */
        n = i - 1u;
    copied = n < bytes ? n : bytes - 1u;
    memcpy(name, start, copied);
    name[copied] = '\0';
    return n;
}

int host_starts_with(const unsigned char *head, size_t n, const char *text)
{
    const size_t k = strlen(text);
    return n >= k && memcmp(head, text, k) == 0;
}

char *host_path_in(const char *directory, const char *name)
{
    const size_t n = strlen(directory) + strlen(name) + 2u;
    char *const path = malloc(n);
    if (path != NULL)
        (void)snprintf(path, n, "%s/%s", directory, name);
    return path;
}

void host_path_to_parent(char *path)
{
    size_t n = strlen(path);
    while (n > 1 && path[n - 1u] == '/')
        n--;
    while (n > 0 && path[n - 1u] != '/')
        n--;
    while (n > 1 && path[n - 1u] == '/')
        n--;
    if (n == 0)
        path[n++] = '.';
    path[n] = '\0';
}

/* The directory of a file, from the root, without links. Owned by the caller; NULL when there is none. */
static char *directory_of(const char *file)
{
    const size_t n = strlen(file) + 2u; /* "." is the parent of "" */
    char *const copy = malloc(n);
    if (copy == NULL)
        return NULL;
    (void)snprintf(copy, n, "%s", file);
    host_path_to_parent(copy);
    char *found = realpath(copy, NULL);
    free(copy);
    if (found != NULL && strcmp(found, "/") == 0)
        found[0] = '\0';
    return found;
}

/* Bytes of the directories that both have, from the root: a path ends there, or a slash follows. */
static size_t common(const char *a, const char *b)
{
    size_t i = 0, end = 0;
    for (i = 0; a[i] != '\0' && a[i] == b[i]; i++)
        if (a[i] == '/')
            end = i;
    return (a[i] == '\0' || a[i] == '/') && (b[i] == '\0' || b[i] == '/') ? i : end;
}

/* What leads from one directory to a file in another. */
static char *join(const char *from, const char *to, const char *name)
{
    const size_t same = common(from, to);
    size_t up = 0, n = 0;
    for (size_t i = same; from[i] != '\0'; i++)
        up += from[i] == '/';
    n = 3u * up + strlen(to + same) + strlen(name) + 2u;
    char *path = malloc(n);
    if (path == NULL)
        return NULL;
    for (size_t i = 0; i < up; i++)
        memcpy(path + 3u * i, "../", 3);
    to += same + (to[same] == '/');
    (void)snprintf(path + 3u * up, n - 3u * up, "%s%s%s", to, *to != '\0' ? "/" : "", name);
    return path;
}

char *host_relative_path(const char *from, const char *file)
{
    const char *const slash = strrchr(file, '/');
    char *const a = directory_of(from), *const b = directory_of(file);
    char *const path = a != NULL && b != NULL ? join(a, b, slash != NULL ? slash + 1 : file) : NULL;
    free(a);
    free(b);
    return path;
}

#define HEAD_BYTES 352u  /* NIfTI's magic ends here, the last of all */
#define DEPTH_MAX 4      /* of folders in a DICOM folder */
#define ENTRIES_MAX 200u /* looked at in each */

typedef struct sign {
    const char *text; /* the bytes, or the extension */
    size_t at;        /* where the bytes stand */
    int kind;
    const char *name; /* with its article */
} sign;

static const sign first_bytes[] = {
    {"DICM", 128, HOST_KIND_DICOM, "a DICOM file"},
    {"ply\n", 0, HOST_KIND_SURFACE, "a PLY surface"},
    {"ply\r", 0, HOST_KIND_SURFACE, "a PLY surface"},
    {"solid ", 0, HOST_KIND_SURFACE, "an STL surface"},
    {"# vtk DataFile", 0, HOST_KIND_SURFACE, "a VTK file"},
    {"NRRD0", 0, HOST_KIND_VOLUME, "an NRRD volume"},
    {"ObjectType", 0, HOST_KIND_VOLUME, "a MetaImage volume"},
    {"NDims", 0, HOST_KIND_VOLUME, "a MetaImage volume"},
    {"n+1", 344, HOST_KIND_VOLUME, "a NIfTI volume"},
    {"n+2", 4, HOST_KIND_VOLUME, "a NIfTI volume"},
    {"SMR1", 0, HOST_KIND_MODEL, "a model made by smr build"},
    {"# Markups fiducial file", 0, HOST_KIND_LANDMARKS, "a file of landmarks"},
};
static const sign extensions[] = {
    {".ply", 0, HOST_KIND_SURFACE, "a PLY surface"},
    {".stl", 0, HOST_KIND_SURFACE, "an STL surface"},
    {".obj", 0, HOST_KIND_SURFACE, "an OBJ surface"},
    {".vtk", 0, HOST_KIND_SURFACE, "a VTK file"},
    {".mha", 0, HOST_KIND_VOLUME, "a MetaImage volume"},
    {".mhd", 0, HOST_KIND_VOLUME, "a MetaImage volume"},
    {".nii", 0, HOST_KIND_VOLUME, "a NIfTI volume"},
    {".nrrd", 0, HOST_KIND_VOLUME, "an NRRD volume"},
    {".nhdr", 0, HOST_KIND_VOLUME, "an NRRD volume"},
    {".smr", 0, HOST_KIND_MODEL, "a model made by smr build"},
    {".mrk.json", 0, HOST_KIND_LANDMARKS, "a file of landmarks"},
    {".fcsv", 0, HOST_KIND_LANDMARKS, "a file of landmarks"},
    {".csv", 0, HOST_KIND_LANDMARKS, "a file of landmarks"},
    {".dcm", 0, HOST_KIND_DICOM, "a DICOM file"},
    {".ima", 0, HOST_KIND_DICOM, "a DICOM file"},
};

/* By the content, or by the extension where the content does not decide; NULL: unknown. */
static const sign *sign_of(const char *path, const unsigned char *head, size_t n)
{
    for (size_t i = 0; i < sizeof first_bytes / sizeof first_bytes[0]; i++) {
        const sign *const s = &first_bytes[i];
        if (n >= s->at && host_starts_with(head + s->at, n - s->at, s->text))
            return s;
    }
    for (size_t i = 0; i < sizeof extensions / sizeof extensions[0]; i++)
        if (host_has_extension(path, extensions[i].text))
            return &extensions[i];
    return NULL;
}

/* Without O_NONBLOCK, opening a named pipe without a writer would block for ever. */
static const sign *sign_of_file(const char *path)
{
    unsigned char head[HEAD_BYTES];
    struct stat st;
    ssize_t n = 0;
    const int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0)
        return NULL;
    if (fstat(fd, &st) == 0 && S_ISREG(st.st_mode))
        n = read(fd, head, sizeof head);
    (void)close(fd);
    return n > 0 ? sign_of(path, head, (size_t)n) : NULL;
}

int host_file_kind(const char *path)
{
    const sign *const found = sign_of_file(path);
    return found != NULL ? found->kind : HOST_KIND_UNKNOWN;
}

void host_kind_found(host_error *error, const char *path, const unsigned char *head, size_t n)
{
    const sign *const found = sign_of(path, head, n);
    char wanted[sizeof error->expected], folder[64];
    if (found == NULL || strcmp(error->place, "content") != 0)
        return;
    (void)snprintf(wanted, sizeof wanted, "%.*s", (int)strcspn(error->expected, ";"), error->expected);
    if (found->kind != HOST_KIND_DICOM) {
        (void)host_fail(error, "content", "%.180s, found %s", wanted, found->name);
        return;
    }
    (void)snprintf(folder, sizeof folder, "%s", path);
    host_path_to_parent(folder);
    if (strlen(path) >= sizeof folder) /* cut: of no use in a command */
        (void)snprintf(folder, sizeof folder, "FOLDER");
    (void)host_fail(error, "content", "%.110s, found %s: dcm2niix -z y -o . '%s' makes a volume", wanted, found->name,
                    folder);
}

/* 1 when a DICOM file is among the first files of the directory or of its directories. */
static int holds_dicom(const char *path, int depth)
{
    DIR *const directory = depth > 0 ? opendir(path) : NULL;
    const struct dirent *entry = NULL;
    unsigned n = 0;
    int found = 0;
    while (directory != NULL && !found && n++ < ENTRIES_MAX && (entry = readdir(directory)) != NULL) {
        char below[1024];
        const int length = snprintf(below, sizeof below, "%s/%s", path, entry->d_name);
        struct stat st;
        if (entry->d_name[0] == '.' || length < 0 || (size_t)length >= sizeof below || stat(below, &st) != 0)
            continue;
        found = S_ISDIR(st.st_mode) ? holds_dicom(below, depth - 1) : host_file_kind(below) == HOST_KIND_DICOM;
    }
    if (directory != NULL)
        (void)closedir(directory);
    return found;
}

int host_kind_refuse_directory(host_error *error, const char *path)
{
    if (!holds_dicom(path, DEPTH_MAX))
        return host_fail(error, "file", "a regular file, not a directory");
    return host_fail(error, "file", "a file, found a folder of DICOM files: dcm2niix -z y -o . '%.130s' makes a volume",
                     path);
}
