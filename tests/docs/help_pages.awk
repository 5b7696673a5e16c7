# help_pages.awk: man pages and shell completion from the records of help_pages.c.
# SPDX-License-Identifier: MIT
# usage: help_pages | awk -v dir=DIR -f help_pages.awk        writes DIR/smr.1, DIR/smr-COMMAND.1, DIR/smr.bash and DIR/_smr

# A text of a man page: hyphens that can be copied, no backslash of its own, no line that looks like a request.
function roff(text) {
    gsub(/\\/, "\\\\e", text); gsub(/-/, "\\\\-", text)
    return (text ~ /^[.']/ ? "\\&" : "") text
}
# Between single quotes, and where brackets and colons have a meaning.
function zsh(text) { gsub(/\\/, "\\\\\\\\", text); gsub(/\[|\]|:/, "\\\\&", text); gsub(/'/, "'\\\\''", text); return text }
function spaced(words) { gsub(/[|]/, " ", words); return words }
function head(title, name, purpose) { # the date is the version's: the same sources say the same
    return ".TH SMR" title " 1 2026-11-23 \"smr " version "\" \"smr manual\"\n.SH NAME\nsmr" name " \\- " roff(purpose) "\n.SH SYNOPSIS\n"
}
# "1 it failed; 3 look": an entry for each; what stands before the first number goes above.
function statuses(text,    n, i, part, out) {
    n = split(text, part, /;[; ]*/)
    for (i = 1; i <= n; i++)
        if (match(part[i], /^[0-9]+ ?/))
            out = out ".TP\n.B " (part[i] + 0) "\n" roff(substr(part[i], RLENGTH + 1)) "\n"
        else if (part[i] != "") out = out ".PP\n" roff(part[i]) "\n"
    return out
}
function see_also(but,    i, out) {
    out = ".SH SEE ALSO\n"
    if (but) out = out ".BR smr (1)"
    for (i = 1; i <= n_commands; i++)
        if (i != but) out = out (but || i > 1 ? ",\n" : "") ".BR smr\\-" name[i] " (1)"
    return out "\n"
}

BEGIN { FS = "\t" }
$1 == "version" { version = $2 }
$1 == "status" { status = $2 }
$1 == "group" { group[n_groups++] = $2 }
$1 == "command" { name[c = ++n_commands] = $2; purpose[c] = $3; own[c] = $4 }
$1 == "synopsis" {
    takes_files[c] = synopsis[c] == "" ? $2 !~ /^-/ : takes_files[c]
    synopsis[c] = synopsis[c] (synopsis[c] == "" ? "" : ".br\n") ".B smr " name[c] "\n" roff($2) "\n"
}
$1 == "paragraph" { about[c] = about[c] (about[c] == "" ? ".SH DESCRIPTION\n" : ".PP\n") roff($2) "\n" }
$1 == "option" {
    option[c] = option[c] " " $3
    manual[c, $6] = manual[c, $6] ".TP\n\\fB" roff($3) "\\fR" ($4 != "" ? " \\fI" roff($4) "\\fR" : "") "\n" roff($5) "\n"
    kinds[c] = kinds[c] "        " $3 ") kind=" $7 " many=" $8 ($7 == "words" ? " words='" spaced($9) "'" : "") " ;;\n"
    action = $7 == "words" ? "(" spaced($9) ")" : $7 == "file" ? "_files" : $7 == "directory" ? "_files -/" : ""
    arguments[c] = arguments[c] "            '" $3 "[" zsh($5) "]" \
        ($7 == "flag" ? "" : ($8 ? ":*-*:" : ":") zsh($4) ":" action) "' \\\n"
}

END {
    page = dir "/smr.1"
    printf "%s", head("", "", "shape-matching registration of surfaces onto surfaces or images") \
        ".B smr\n\\fICOMMAND\\fR [\\fIOPTION\\fR]...\n.br\n.B smr\n\\-\\-help | \\-\\-version | \\fICOMMAND\\fR \\-\\-help\n" \
        ".SH DESCRIPTION\nDeforms a prepared model, bones and muscles, onto a patient's surfaces or into an " \
        "image, with the same bits\non every processor and for any number of threads. Each command has a page of its own.\n" \
        ".SH COMMANDS\n" >page
    for (i = 1; i <= n_commands; i++) printf ".TP\n.BR smr\\-%s (1)\n%s\n", name[i], roff(purpose[i]) >page
    printf "%s", ".SH EXIT STATUS\n" statuses(status) ".PP\nMore of them have a meaning of their own with some commands.\n" \
        see_also(0) >page
    for (c = 1; c <= n_commands; c++) {
        page = dir "/smr-" name[c] ".1"
        printf "%s", head("\\-" toupper(name[c]), "\\-" name[c], purpose[c]) synopsis[c] about[c] ".SH OPTIONS\n" >page
        for (g = 0; g < n_groups; g++)
            if ((c, g) in manual) printf "%s", (g > 0 ? ".SS " group[g] "\n" : "") manual[c, g] >page
        printf "%s", ".TP\n\\fB\\-\\-help\\fR\nthis text, shorter\n.SH EXIT STATUS\n" statuses(status) statuses(own[c]) see_also(c) >page
    }

    page = dir "/smr.bash"
    printf "%s", "# smr: completion for bash. SPDX-License-Identifier: MIT\n" \
        "_smr() {\n" \
        "    local word=${COMP_WORDS[COMP_CWORD]} option='' options='' kind=flag many=1 words='' at\n" \
        "    COMPREPLY=()\n" \
        "    if ((COMP_CWORD == 1)); then\n" \
        "        mapfile -t COMPREPLY < <(compgen -W '" >page
    for (c = 1; c <= n_commands; c++) printf "%s ", name[c] >page
    printf "%s", "--help --version' -- \"$word\")\n" \
        "        return\n" \
        "    fi\n" \
        "    # The option that the word stands behind; without one it is a file of the command's own.\n" \
        "    for ((at = COMP_CWORD - 1; at > 1; at--)); do\n" \
        "        case ${COMP_WORDS[at]} in -[a-z-]*) option=${COMP_WORDS[at]}; break ;; esac\n" \
        "    done\n" \
        "    case ${COMP_WORDS[1]} in\n" >page
    for (c = 1; c <= n_commands; c++)
        printf "%s", "    " name[c] ")\n" (takes_files[c] ? "        kind=file\n" : "") "        options='--help" option[c] \
            "'\n        case $option in\n" kinds[c] "        esac ;;\n" >page
    printf "%s", "    *) return ;;\n" \
        "    esac\n" \
        "    # Behind a flag, or behind the one value that an option takes, there are options again.\n" \
        "    if [[ $word == -* || $kind == flag || ($many == 0 && $((COMP_CWORD - at)) -gt 1) ]]; then\n" \
        "        mapfile -t COMPREPLY < <(compgen -W \"$options\" -- \"$word\")\n" \
        "    elif [ \"$kind\" = words ]; then\n" \
        "        mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")\n" \
        "    elif [ \"$kind\" != none ]; then\n" \
        "        compopt -o filenames 2>/dev/null\n" \
        "        mapfile -t COMPREPLY < <(compgen -A \"$kind\" -- \"$word\")\n" \
        "    fi\n" \
        "}\n" \
        "complete -F _smr smr\n" >page

    page = dir "/_smr"
    print "#compdef smr\n# smr: completion for zsh. SPDX-License-Identifier: MIT\n_smr() {\n    local -a commands=(" >page
    for (c = 1; c <= n_commands; c++) printf "        '%s:%s'\n", name[c], zsh(purpose[c]) >page
    print "        '--help:what there is' '--version:of the program')\n    if (( CURRENT == 2 )); then\n" \
        "        _describe command commands\n        return\n    fi\n    local command=$words[2]\n" \
        "    shift words\n    (( CURRENT-- ))\n    case $command in" >page
    for (c = 1; c <= n_commands; c++)
        printf "%s", "    (" name[c] ")\n        _arguments \\\n" arguments[c] \
            "            '--help[all options]' '*:FILE:_files' ;;\n" >page
    print "    esac\n}\n_smr \"$@\"" >page
    exit !n_commands
}
