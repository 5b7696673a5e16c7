/* main.c: smr: the command line program.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>
#include "commands/commands.h"
#include "options/options_table.h"

/* Opens closed standard streams: otherwise the next opened file would take their place. */
static void keep_streams_open(void)
{
    int fd = 0;
    do
        fd = open("/dev/null", O_RDWR);
    while (fd >= 0 && fd <= 2);
    if (fd > 2)
        (void)close(fd);
}

static const struct {
    const char *name;
    int command;
    int (*run)(const host_options *options, host_error *error);
} commands[] = {{"register", HOST_REGISTER, host_register},
                {"build", HOST_BUILD, host_build},
                {"info", HOST_INFO, host_info},
                {"measure", HOST_MEASURE, host_measure},
                {"phantom", HOST_PHANTOM, host_phantom},
                {"bench", HOST_BENCH, host_bench_run},
                {"replay", HOST_REPLAY, host_replay},
                {"carry", HOST_CARRY, host_carry},
                {"field", HOST_FIELD, host_field},
                {"warp", HOST_WARP, host_warp},
                {"track", HOST_TRACK, host_track},
                {"summary", HOST_SUMMARY, host_summary},
                {"surfaces", HOST_SURFACES, host_surfaces},
                {"labels", HOST_LABELS, host_labels}};

static int run(size_t i, int argc, char **argv, host_error *error)
{
    host_options options;
    int result = HOST_REFUSED;
    if (host_options_read(commands[i].command, argc, argv, &options, error) == 0)
        result = commands[i].run(&options, error);
    if (result == HOST_REFUSED)
        host_error_print(error);
    host_options_free(&options);
    return result;
}

static int dispatch(int argc, char **argv, host_error *error)
{
    for (int k = 1; k < argc; k++)
        if (strcmp(argv[k], "--help") == 0 || strcmp(argv[k], "-h") == 0) {
            if (argv[1][0] == '-')
                host_help();
            else if (host_command_help(argv[1]) != 0)
                break; /* no such command, which is told below */
            return HOST_DONE;
        }
    if (argc == 2 && strcmp(argv[1], "--version") == 0) {
        (void)printf("smr %d.%d.%d\n", SMR_VERSION_MAJOR, SMR_VERSION_MINOR, SMR_VERSION_PATCH);
        return HOST_DONE;
    }
    if (argc == 3 && strcmp(argv[1], "register") == 0 && strcmp(argv[2], "--xml") == 0)
        return host_module_xml() == 0 ? HOST_DONE : HOST_REFUSED;
    if (smr_built_without()[0] != '\0') { /* commands need all that the library can */
        (void)fprintf(stderr, "smr: built without %s\n", smr_built_without());
        return HOST_REFUSED;
    }
    for (size_t i = 0; argc > 1 && i < sizeof commands / sizeof commands[0]; i++)
        if (strcmp(argv[1], commands[i].name) == 0)
            return run(i, argc, argv, error);
    error->file = argc > 1 ? argv[1] : "usage";
    (void)host_fail(error, "command",
                    "register, build, info, measure, phantom, bench, replay, carry, field, warp, track, summary, "
                    "surfaces, labels, --help or --version");
    host_error_print(error);
    return HOST_REFUSED;
}

int main(int argc, char **argv)
{
    host_error error = {0};
    keep_streams_open();
    (void)signal(SIGXFSZ, SIG_IGN); /* makes an exceeded file size limit a write error */
    int result = dispatch(argc, argv, &error);
    if (fflush(stdout) != 0 || ferror(stdout)) {
        error.file = "standard output";
        (void)host_fail(&error, "output", "room for the text (%s)", strerror(errno));
        if (result != HOST_REFUSED)
            host_error_print(&error);
        result = HOST_REFUSED;
    }
    return result;
}
