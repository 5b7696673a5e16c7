/* help_pages.c: man pages and shell completion, from the tables that `smr COMMAND --help` is printed from.
 * usage: help_pages DIR        writes DIR/smr.1, DIR/smr-COMMAND.1, DIR/smr.bash and DIR/_smr
 *        help_pages --list     a line for each option of each command: command, option, value, sentence, by tabs
 * SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "options/command_text.h"
#include "options/option_text.h"

#define PAGES_DATE "2026-11-23" /* of the version: a page says when it was written, and the same sources say the same */

static FILE *page;

static void put(const char *text) { (void)fputs(text, page); }

/* A text of a man page: hyphens that can be copied, no backslash of its own, no line that looks like a request. */
static void put_roff(const char *text)
{
    if (*text == '.' || *text == '\'')
        put("\\&");
    for (; *text != '\0'; text++)
        if (*text == '-')
            put("\\-");
        else if (*text == '\\')
            put("\\e");
        else
            (void)fputc(*text, page);
}

static void put_upper(const char *text)
{
    for (; *text != '\0'; text++)
        (void)fputc(*text >= 'a' && *text <= 'z' ? *text - 'a' + 'A' : *text, page);
}

static int open_page(const char *dir, const char *name)
{
    char path[4096];
    (void)snprintf(path, sizeof path, "%s/%s", dir, name);
    page = fopen(path, "w");
    if (page == NULL)
        (void)fprintf(stderr, "help_pages: %s cannot be written\n", path);
    return page == NULL ? -1 : 0;
}

static int close_page(void)
{
    const int bad = ferror(page);
    return fclose(page) != 0 || bad ? -1 : 0;
}

/* ------------------------------------------------------------------ man pages */

static void man_head(const char *command, const char *purpose)
{
    put(".TH SMR");
    if (command != NULL) {
        put("\\-");
        put_upper(command);
    }
    (void)fprintf(page, " 1 %s \"smr %d.%d.%d\" \"smr manual\"\n.SH NAME\nsmr%s", PAGES_DATE, SMR_VERSION_MAJOR,
                  SMR_VERSION_MINOR, SMR_VERSION_PATCH, command != NULL ? "\\-" : "");
    put(command != NULL ? command : "");
    put(" \\- ");
    put_roff(purpose);
    put("\n.SH SYNOPSIS\n");
}

/* In parts that man prints in one line each. */
static void man_status(const char *number, const char *text)
{
    (void)fprintf(page, ".TP\n.B %s\n", number);
    put_roff(text);
    put("\n");
}

/* "1 it failed; 3 look": an entry for each; what stands before the first number goes above. */
static void man_statuses(const char *text)
{
    char part[256];
    while (*text != '\0') {
        const size_t n = strcspn(text, ";");
        (void)snprintf(part, sizeof part, "%.*s", (int)n, text);
        const size_t digits = strspn(part, "0123456789");
        if (digits > 0) {
            char number[16];
            (void)snprintf(number, sizeof number, "%.*s", (int)(digits < 9u ? digits : 9u), part);
            man_status(number, part + digits + (part[digits] == ' '));
        } else {
            put(".PP\n");
            put_roff(part);
            put("\n");
        }
        text += n;
        text += strspn(text, "; ");
    }
}

static void man_option(const host_option *o, int command)
{
    char sentence[512];
    const char *const value = host_option_value(o, command);
    host_option_sentence(o, command, sentence, sizeof sentence);
    put(".TP\n\\fB");
    put_roff(o->name);
    put("\\fR");
    if (value[0] != '\0') {
        put(" \\fI");
        put_roff(value);
        put("\\fR");
    }
    put("\n");
    put_roff(sentence);
    put("\n");
}

static void man_options(const host_command_text *c)
{
    size_t group = 0, i = 0;
    put(".SH OPTIONS\n");
    for (group = 0; host_option_groups[group] != NULL; group++) {
        int begun = group == 0;
        for (i = 0; i < host_option_count; i++) {
            const host_option *const o = &host_option_table[i];
            if ((o->commands & c->command) == 0 || host_option_group(o, c->command) != group)
                continue;
            if (!begun)
                (void)fprintf(page, ".SS %s\n", host_option_groups[group]);
            begun = 1;
            man_option(o, c->command);
        }
    }
    put(".TP\n\\fB\\-\\-help\\fR\nthis text, shorter\n");
}

static void man_see_also(const char *but)
{
    size_t i = 0;
    put(".SH SEE ALSO\n");
    if (but != NULL)
        put(".BR smr (1)");
    for (i = 0; i < host_command_count; i++)
        if (but == NULL || strcmp(host_command_texts[i].name, but) != 0)
            (void)fprintf(page, "%s.BR smr\\-%s (1)", but != NULL || i > 0 ? ",\n" : "", host_command_texts[i].name);
    put("\n");
}

static int man_command(const char *dir, const host_command_text *c)
{
    char name[64];
    size_t i = 0;
    (void)snprintf(name, sizeof name, "smr-%s.1", c->name);
    if (open_page(dir, name) != 0)
        return -1;
    man_head(c->name, c->purpose);
    for (i = 0; c->synopsis[i] != NULL; i++) {
        (void)fprintf(page, "%s.B smr %s\n", i > 0 ? ".br\n" : "", c->name);
        put_roff(c->synopsis[i]);
        put("\n");
    }
    for (i = 0; c->paragraph[i] != NULL; i++) {
        put(i == 0 ? ".SH DESCRIPTION\n" : ".PP\n");
        put_roff(c->paragraph[i]);
        put("\n");
    }
    man_options(c);
    put(".SH EXIT STATUS\n");
    man_statuses(host_status_text);
    man_statuses(c->status);
    man_see_also(c->name);
    return close_page();
}

static int man_all(const char *dir)
{
    size_t i = 0;
    int result = open_page(dir, "smr.1");
    if (result != 0)
        return -1;
    man_head(NULL, "shape-matching registration of surfaces onto surfaces or images");
    put(".B smr\n\\fICOMMAND\\fR [\\fIOPTION\\fR]...\n.br\n.B smr\n\\-\\-help | \\-\\-version | \\fICOMMAND\\fR "
        "\\-\\-help\n.SH DESCRIPTION\nDeforms a prepared model, bones and muscles, onto a patient's surfaces or into "
        "an "
        "image, with the same bits\non every processor and for any number of threads. Each command has a page of its "
        "own.\n.SH COMMANDS\n");
    for (i = 0; i < host_command_count; i++) {
        (void)fprintf(page, ".TP\n.BR smr\\-%s (1)\n", host_command_texts[i].name);
        put_roff(host_command_texts[i].purpose);
        put("\n");
    }
    put(".SH EXIT STATUS\n");
    man_statuses(host_status_text);
    put(".PP\nMore of them have a meaning of their own with some commands.\n");
    man_see_also(NULL);
    result = close_page();
    for (i = 0; result == 0 && i < host_command_count; i++)
        result = man_command(dir, &host_command_texts[i]);
    return result;
}

/* ------------------------------------------------------------------ completion */

/* What a word behind the option may be: "words", "directory", "file", "none" (a number), "flag". */
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

/* "x|y|z" with another sign between the words. */
static void put_words(const char *words, const char *between)
{
    for (; *words != '\0'; words++)
        if (*words == '|')
            put(between);
        else
            (void)fputc(*words, page);
}

static void bash_command(const host_command_text *c)
{
    size_t i = 0;
    (void)fprintf(page, "    %s)\n%s        options='--help", c->name,
                  c->synopsis[0][0] == '-' ? "" : "        kind=file\n");
    for (i = 0; i < host_option_count; i++)
        if ((host_option_table[i].commands & c->command) != 0)
            (void)fprintf(page, " %s", host_option_table[i].name);
    put("'\n        case $option in\n");
    for (i = 0; i < host_option_count; i++) {
        const host_option *const o = &host_option_table[i];
        const char *const kind = value_kind(o, c->command);
        if ((o->commands & c->command) == 0)
            continue;
        (void)fprintf(page, "        %s) kind=%s many=%d", o->name, kind, o->kind == HOST_KIND_FILES);
        if (strcmp(kind, "words") == 0) {
            put(" words='");
            put_words(host_option_words(o), " ");
            put("'");
        }
        put(" ;;\n");
    }
    put("        esac ;;\n");
}

static const char bash_head[] =
    "# smr: completion for bash. SPDX-License-Identifier: MIT\n"
    "_smr() {\n"
    "    local word=${COMP_WORDS[COMP_CWORD]} option='' options='' kind=flag many=1 words='' at\n"
    "    COMPREPLY=()\n"
    "    if ((COMP_CWORD == 1)); then\n"
    "        mapfile -t COMPREPLY < <(compgen -W '";

static const char bash_body[] =
    "--help --version' -- \"$word\")\n"
    "        return\n"
    "    fi\n"
    "    # The option that the word stands behind; without one it is a file of the command's own.\n"
    "    for ((at = COMP_CWORD - 1; at > 1; at--)); do\n"
    "        case ${COMP_WORDS[at]} in -[a-z-]*) option=${COMP_WORDS[at]}; break ;; esac\n"
    "    done\n"
    "    case ${COMP_WORDS[1]} in\n";

static const char bash_tail[] =
    "    *) return ;;\n"
    "    esac\n"
    "    # Behind a flag, or behind the one value that an option takes, there are options again.\n"
    "    if [[ $word == -* || $kind == flag || ($many == 0 && $((COMP_CWORD - at)) -gt 1) ]]; then\n"
    "        mapfile -t COMPREPLY < <(compgen -W \"$options\" -- \"$word\")\n"
    "    elif [ \"$kind\" = words ]; then\n"
    "        mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")\n"
    "    elif [ \"$kind\" != none ]; then\n"
    "        compopt -o filenames 2>/dev/null\n"
    "        mapfile -t COMPREPLY < <(compgen -A \"$kind\" -- \"$word\")\n"
    "    fi\n"
    "}\n"
    "complete -F _smr smr\n";

static int bash_all(const char *dir)
{
    size_t i = 0;
    if (open_page(dir, "smr.bash") != 0)
        return -1;
    put(bash_head);
    for (i = 0; i < host_command_count; i++)
        (void)fprintf(page, "%s ", host_command_texts[i].name);
    put(bash_body);
    for (i = 0; i < host_command_count; i++)
        bash_command(&host_command_texts[i]);
    put(bash_tail);
    return close_page();
}

/* Between single quotes, and where brackets and colons have a meaning. */
static void put_zsh(const char *text)
{
    for (; *text != '\0'; text++) {
        if (*text == '\'')
            put("'\\'");
        else if (strchr("[]:\\", *text) != NULL)
            put("\\");
        (void)fputc(*text, page);
    }
}

static void zsh_option(const host_option *o, int command)
{
    const char *const kind = value_kind(o, command);
    char sentence[512];
    host_option_sentence(o, command, sentence, sizeof sentence);
    (void)fprintf(page, "            '%s[", o->name);
    put_zsh(sentence);
    put("]");
    if (strcmp(kind, "flag") != 0) {
        put(o->kind == HOST_KIND_FILES ? ":*-*:" : ":");
        put_zsh(host_option_value(o, command));
        put(":");
    }
    if (strcmp(kind, "words") == 0) {
        put("(");
        put_words(host_option_words(o), " ");
        put(")");
    } else if (strcmp(kind, "file") == 0 || strcmp(kind, "directory") == 0) {
        put(kind[0] == 'f' ? "_files" : "_files -/");
    }
    put("' \\\n");
}

static int zsh_all(const char *dir)
{
    size_t i = 0, k = 0;
    if (open_page(dir, "_smr") != 0)
        return -1;
    put("#compdef smr\n# smr: completion for zsh. SPDX-License-Identifier: MIT\n_smr() {\n    local -a commands=(\n");
    for (i = 0; i < host_command_count; i++) {
        (void)fprintf(page, "        '%s:", host_command_texts[i].name);
        put_zsh(host_command_texts[i].purpose);
        put("'\n");
    }
    put("        '--help:what there is' '--version:of the program')\n    if (( CURRENT == 2 )); then\n"
        "        _describe command commands\n        return\n    fi\n    local command=$words[2]\n"
        "    shift words\n    (( CURRENT-- ))\n    case $command in\n");
    for (i = 0; i < host_command_count; i++) {
        (void)fprintf(page, "    (%s)\n        _arguments \\\n", host_command_texts[i].name);
        for (k = 0; k < host_option_count; k++)
            if ((host_option_table[k].commands & host_command_texts[i].command) != 0)
                zsh_option(&host_option_table[k], host_command_texts[i].command);
        put("            '--help[all options]' '*:FILE:_files' ;;\n");
    }
    put("    esac\n}\n_smr \"$@\"\n");
    return close_page();
}

static void list(void)
{
    size_t i = 0, k = 0;
    char sentence[512];
    for (i = 0; i < host_command_count; i++)
        for (k = 0; k < host_option_count; k++) {
            const host_option *const o = &host_option_table[k];
            const int command = host_command_texts[i].command;
            if ((o->commands & command) == 0)
                continue;
            host_option_sentence(o, command, sentence, sizeof sentence);
            (void)printf("%s\t%s\t%s\t%s\n", host_command_texts[i].name, o->name, host_option_value(o, command),
                         sentence);
        }
}

int main(int argc, char **argv)
{
    if (argc == 2 && strcmp(argv[1], "--list") == 0) {
        list();
        return 0;
    }
    if (argc != 2)
        return 2;
    return man_all(argv[1]) != 0 || bash_all(argv[1]) != 0 || zsh_all(argv[1]) != 0;
}
