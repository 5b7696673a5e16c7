/* file_kind.c: tells surfaces, volumes, landmarks, prepared models and DICOM apart.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include "files/file_kind.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "files/file_names.h"

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
    size_t i = 0;
    for (i = 0; i < sizeof first_bytes / sizeof first_bytes[0]; i++) {
        const sign *const s = &first_bytes[i];
        const size_t k = strlen(s->text);
        if (n >= s->at + k && memcmp(head + s->at, s->text, k) == 0)
            return s;
    }
    for (i = 0; i < sizeof extensions / sizeof extensions[0]; i++)
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
