/* help_pages.c: the tables that `smr COMMAND --help` is printed from, for help_pages.awk: a line a record, by tabs.
 *   version V | status S | group G | command NAME PURPOSE STATUS | synopsis S | paragraph P
 *   option COMMAND NAME VALUE SENTENCE GROUP KIND MANY WORDS
 * KIND: what the word behind the option is: words, directory, file, none (a number) or flag. MANY: 1 for several files.
 * SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>
#include "options/options_table.h"

static const char *value_kind(const host_option *o, int command)
{
    const char *const value = host_option_value(o, command);
    if (o->kind == HOST_KIND_FLAG)
        return "flag";
    if (o->kind == HOST_KIND_WORD)
        return "words";
    if (o->kind == HOST_KIND_FILES)
        return "file";
    if (o->kind != HOST_KIND_TEXT || strcmp(value, "W|hard") == 0 || strcmp(value, "NAME") == 0)
        return "none";
    return strcmp(value, "DIR") == 0 ? "directory" : "file"; /* a file may be a directory, too */
}

static void print_option(const host_option *o, const host_command_text *c)
{
    const char *const kind = value_kind(o, c->command);
    char sentence[512];
    host_option_sentence(o, c->command, sentence, sizeof sentence);
    (void)printf("option\t%s\t%s\t%s\t%s\t%zu\t%s\t%d\t%s\n", c->name, o->name, host_option_value(o, c->command),
                 sentence, host_option_group(o, c->command), kind, o->kind == HOST_KIND_FILES,
                 strcmp(kind, "words") == 0 ? host_option_words(o) : "");
}

int main(void)
{
    (void)printf("version\t%d.%d.%d\nstatus\t%s\n", SMR_VERSION_MAJOR, SMR_VERSION_MINOR, SMR_VERSION_PATCH,
                 host_status_text);
    for (size_t i = 0; host_option_groups[i] != NULL; i++)
        (void)printf("group\t%s\n", host_option_groups[i]);
    for (size_t i = 0; i < host_command_count; i++) {
        const host_command_text *const c = &host_command_texts[i];
        (void)printf("command\t%s\t%s\t%s\n", c->name, c->purpose, c->status);
        for (size_t k = 0; c->synopsis[k] != NULL; k++)
            (void)printf("synopsis\t%s\n", c->synopsis[k]);
        for (size_t k = 0; c->paragraph[k] != NULL; k++)
            (void)printf("paragraph\t%s\n", c->paragraph[k]);
        for (size_t k = 0; k < host_option_count; k++)
            if ((host_option_table[k].commands & c->command) != 0)
                print_option(&host_option_table[k], c);
    }
    return 0;
}
