/* settings_page.c: writes the page of settings from the library's tables of settings and the command line's of options.
 * usage: settings_page            the page, on stdout
 *        settings_page --header   one line a field: name, tab, how its comment in smr.h has to start
 * SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>
#include "options/options_table.h"

#define PAGE_TEXT 128

/* Options that set more than one setting, or set it from something else, so that their table does not name it. */
static const struct {
    const char *setting, *option;
} page_further[] = {
    {"n_workers", "--threads"},          {"search_mm", "--search"},         {"profile_mm", "--search"},
    {"profile_end_mm", "--search"},      {"gradient_end_mm", "--gradient"}, {"n_radii", "--radius"},
    {"separate_below_mm", "--clusters"}, {"reference", "--reference"},      {"port", "--threads"},
};

/* 100000000, not 1e+08; 1e-06, not what a float makes of it. */
static int page_digits(double v) { return v >= 1.0 ? 9 : 7; }

/* A default as people write it; nothing where there is none. */
static void page_value(const smr_setting *s, double value, char *to)
{
    const char *word = s->unit;
    if (strcmp(s->name, "radius_last") == 0) {
        (void)snprintf(to, PAGE_TEXT, "SMR_FINEST");
        return;
    }
    if (s->kind != SMR_SETTING_CHOICE) {
        to[0] = '\0';
        if (value >= s->low || s->or_zero)
            (void)snprintf(to, PAGE_TEXT, "%.*g", page_digits(value), value);
        return;
    }
    for (int i = 0; i < (int)value; i++)
        word = strchr(word, '|') + 1;
    (void)snprintf(to, PAGE_TEXT, "%.*s", (int)strcspn(word, "|"), word);
}

static void page_range(const smr_setting *s, char *to)
{
    if (s->kind == SMR_SETTING_CHOICE) {
        (void)snprintf(to, PAGE_TEXT, "%s", s->unit);
    } else if (s->kind == SMR_SETTING_SWITCH) {
        (void)snprintf(to, PAGE_TEXT, "0 or 1");
    } else if (s->kind == SMR_SETTING_POINTER) {
        to[0] = '\0';
    } else {
        (void)snprintf(to, PAGE_TEXT, "%s%c%.*g, %.*g]", s->or_zero ? "0 or " : "", s->open ? '(' : '[',
                       page_digits(s->low), s->low, page_digits(s->high), s->high);
    }
}

static int page_is_index(const smr_setting *s) { return strcmp(s->unit, "index") == 0; }

static int page_is_option(const char *name)
{
    for (size_t i = 0; i < host_option_count; i++)
        if (strcmp(host_option_table[i].name, name) == 0)
            return 1;
    return 0;
}

/* 1 when the command line has all options that page_further names. */
static int page_further_there(void)
{
    for (size_t i = 0; i < sizeof page_further / sizeof page_further[0]; i++)
        if (!page_is_option(page_further[i].option)) {
            (void)fprintf(stderr, "settings_page: no option %s\n", page_further[i].option);
            return 0;
        }
    return 1;
}

/* The option of `smr` that sets it; "-" for none. */
static const char *page_option(const smr_setting *s)
{
    for (size_t i = 0; i < host_option_count; i++)
        if (host_option_setting(&host_option_table[i]) == s)
            return host_option_table[i].name;
    for (size_t i = 0; i < sizeof page_further / sizeof page_further[0]; i++)
        if (strcmp(page_further[i].setting, s->name) == 0)
            return page_further[i].option;
    return "-";
}

static void page_row(const smr_setting *s)
{
    char range[PAGE_TEXT], value[PAGE_TEXT], image[PAGE_TEXT];
    const char *const option = page_option(s);
    page_range(s, range);
    page_value(s, s->value, value);
    page_value(s, s->image, image);
    (void)printf(strcmp(option, "-") == 0 ? "| `%s` | %s | " : "| `%s` | `%s` | ", s->name, option);
    for (const char *c = range; *c != '\0'; c++)
        (void)printf(*c == '|' ? ", " : "%c", *c);
    (void)printf(" | %s | ", s->kind == SMR_SETTING_CHOICE ? "" : s->unit);
    if (s->kind == SMR_SETTING_POINTER) {
        (void)printf("NULL");
    } else {
        (void)printf("%s%s%s", value, strcmp(value, image) == 0 ? "" : "; into an image ",
                     strcmp(value, image) == 0 ? "" : image);
    }
    (void)printf(" | %s |\n", s->text);
}

static void page_table(const char *title, const smr_setting *s, uint32_t n)
{
    (void)printf("\n## `%s`\n", title);
    for (uint32_t i = 0; i < n; i++) {
        if (s[i].kind == SMR_SETTING_GROUP) {
            (void)printf("\n### %s\n\n| field | option of `smr` | range | unit | default | meaning |\n"
                         "|---|---|---|---|---|---|\n",
                         s[i].name);
        } else {
            page_row(&s[i]);
        }
    }
}

static void page_header(const smr_setting *s, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) {
        char range[PAGE_TEXT], value[PAGE_TEXT], image[PAGE_TEXT];
        if (s[i].kind == SMR_SETTING_GROUP || s[i].kind == SMR_SETTING_POINTER)
            continue;
        page_range(&s[i], range);
        page_value(&s[i], s[i].value, value);
        page_value(&s[i], s[i].image, image);
        (void)printf("%s\t", s[i].name);
        if (s[i].kind == SMR_SETTING_CHOICE)
            (void)printf("SMR_*, default ");
        else if (s[i].kind == SMR_SETTING_SWITCH || page_is_index(&s[i]))
            (void)printf("%s, default ", page_is_index(&s[i]) ? "index" : range);
        else
            (void)printf("%s, %s%s", s[i].unit, range, value[0] == '\0' ? "" : ", default ");
        (void)printf("%s%s%s\n", value, strcmp(value, image) == 0 ? "" : ", ", strcmp(value, image) == 0 ? "" : image);
    }
}

int main(int argc, char **argv)
{
    uint32_t n_config = 0, n_prepare = 0;
    const smr_setting *const config = smr_config_settings(&n_config);
    const smr_setting *const prepare = smr_prepare_settings(&n_prepare);
    if (argc == 2 && strcmp(argv[1], "--header") == 0) {
        page_header(config, n_config);
        page_header(prepare, n_prepare);
        return 0;
    }
    if (!page_further_there())
        return 1;
    (void)puts(
        "# Settings\n\n"
        "`make settings-page` writes this page from `settings_config.def` and `settings_prepare.def`. The same tables\n"
        "set the defaults, check the ranges and describe the options of `smr --help`. `smr.h` says more of each "
        "field.\n"
        "A range `(0, 1]` leaves 0 out. The option `-` means that no option sets the field. With an image `--search`\n"
        "and `--gradient` take two distances: at the start and at the end.");
    page_table("smr_config", config, n_config);
    page_table("smr_prepare_config", prepare, n_prepare);
    return 0;
}
