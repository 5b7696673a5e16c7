/* test_command_options.c: the help of each command lists the options that the command takes, and no others; where the
 * whole help tells of a command, it names none that this command refuses.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L /* dup, fileno */

#include "suite.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "commands/commands.h"
#include "options/options_table.h"

#define LETTERS "abcdefghijklmnopqrstuvwxyz0123456789-"

/* What is printed: the help of a command, or the whole for NULL. Owned by the caller. */
static char *help_of(const char *command)
{
    FILE *const file = tmpfile();
    const int before = dup(1);
    long n = 0;
    assert_non_null(file);
    assert_true(fflush(stdout) == 0 && before >= 0 && dup2(fileno(file), 1) == 1);
    if (command == NULL)
        host_help();
    else
        n = host_command_help(command);
    assert_true(fflush(stdout) == 0 && dup2(before, 1) == 1 && close(before) == 0);
    assert_int_equal(n, 0);
    n = ftell(file);
    rewind(file);
    char *text = calloc((size_t)n + 1u, 1);
    assert_non_null(text);
    assert_int_equal(fread(text, 1, (size_t)n, file), n);
    (void)fclose(file);
    return text;
}

/* Asks the reader of the command line. */
static int is_taken(int command, const char *name, const char *option)
{
    char text[3][64];
    char *argv[4] = {text[0], text[1], text[2], NULL};
    host_options options;
    host_error error;
    memset(&error, 0, sizeof error);
    (void)snprintf(text[0], sizeof text[0], "smr");
    (void)snprintf(text[1], sizeof text[1], "%s", name);
    (void)snprintf(text[2], sizeof text[2], "%s", option);
    int known = host_options_read(command, 3, argv, &options, &error) == 0 ||
                strncmp(error.expected, "an option of this command", 25) != 0;
    host_options_free(&options);
    return known;
}

static int is_listed(const char *help, const char *option)
{
    char line[64];
    const size_t n = (size_t)snprintf(line, sizeof line, "\n  %s", option);
    const char *at = help;
    while ((at = strstr(at, line)) != NULL && at[n] != ' ' && at[n] != '\n')
        at += n;
    return at != NULL;
}

TEST(lists_what_is_taken)
{
    size_t i = 0, k = 0, wrong = 0, taken = 0;
    for (i = 0; i < host_command_count; i++) {
        const host_command_text *const c = &host_command_texts[i];
        char *const help = help_of(c->name);
        for (k = 0; k < host_option_count; k++) {
            const char *const option = host_option_table[k].name;
            const int takes = is_taken(c->command, c->name, option), lists = is_listed(help, option);
            if (takes != lists)
                print_error("smr %s %s: %s, %s\n", c->name, option, takes ? "taken" : "refused",
                            lists ? "listed" : "not listed");
            wrong += takes != lists;
            taken += (size_t)takes;
        }
        free(help);
    }
    assert_int_equal(wrong, 0);
    assert_true(taken >= 100 && taken < host_command_count * host_option_count / 2u);
}

/* Lines that start with "  -" are options that there are. */
TEST(lists_no_strangers)
{
    for (size_t i = 0; i < host_command_count; i++) {
        const host_command_text *const c = &host_command_texts[i];
        char *const help = help_of(c->name);
        const char *at = help;
        while ((at = strstr(at, "\n  -")) != NULL) {
            char option[64];
            at += 3;
            (void)snprintf(option, sizeof option, "%.*s", (int)strspn(at, LETTERS), at);
            if (!is_taken(c->command, c->name, option))
                fail_msg("smr %s --help lists %s, which is refused", c->name, option);
        }
        free(help);
    }
}

static const host_command_text *command_at(const char *text)
{
    const size_t n = strspn(text, LETTERS);
    for (size_t i = 0; i < host_command_count; i++)
        if (strlen(host_command_texts[i].name) == n && strncmp(host_command_texts[i].name, text, n) == 0)
            return &host_command_texts[i];
    return NULL;
}

/* The command that a line of the whole help is of, given that of the line before; NULL: of none. */
static const host_command_text *command_of(const char *line, const host_command_text *before)
{
    if (strncmp(line, "  smr ", 6) == 0)
        return command_at(line + 6);
    return line[0] == ' ' ? before : command_at(line);
}

/* One section stands for several commands: "preparing (register, ...)". */
static int some_take(const char *option)
{
    if (strcmp(option, "--help") == 0 || strcmp(option, "--version") == 0)
        return 1;
    for (size_t i = 0; i < host_command_count; i++)
        if (is_taken(host_command_texts[i].command, host_command_texts[i].name, option))
            return 1;
    return 0;
}

TEST(tells_of_the_right_command)
{
    const host_command_text *of = NULL;
    char *const help = help_of(NULL);
    const char *line = help;
    size_t seen = 0, k = 0;
    for (k = 0; k < host_option_count; k++)
        if (strstr(help, host_option_table[k].name) == NULL)
            fail_msg("smr --help does not name %s", host_option_table[k].name);
    while (*line != '\0') {
        const char *const end = line + strcspn(line, "\n"), *at = line;
        of = command_of(line, of);
        while ((at = strstr(at, "--")) != NULL && at < end) {
            char option[64];
            (void)snprintf(option, sizeof option, "%.*s", (int)strspn(at, LETTERS), at);
            at += strlen(option);
            if (of != NULL ? !is_taken(of->command, of->name, option) : line[0] == ' ' && !some_take(option))
                fail_msg("smr --help tells of %s as of %s, which refuses it", option, of != NULL ? of->name : "some");
            seen += of != NULL;
        }
        line = end + (*end == '\n');
    }
    assert_true(seen >= 100);
    free(help);
}
