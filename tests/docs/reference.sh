#!/bin/sh
# reference: the interface as one HTML page: sections, each declaration with its comment, links between names.
# SPDX-License-Identifier: MIT
# usage: reference.sh HEADER.h >PAGE.html     no file beside it, no network, no script; reads well without colours
set -u
# shellcheck disable=SC2016
exec awk '
function escape(text) { gsub(/&/, "\\&amp;", text); gsub(/</, "\\&lt;", text); gsub(/>/, "\\&gt;", text); return text }

# Words that are declared somewhere become links, but not to the declaration they stand in.
function linked(text, own,    out, word, to) {
    out = ""
    while (match(text, /[A-Za-z_][A-Za-z_0-9]*(\.[A-Za-z_][A-Za-z_0-9]*)*/)) {
        out = out escape(substr(text, 1, RSTART - 1))
        word = substr(text, RSTART, RLENGTH); text = substr(text, RSTART + RLENGTH); to = word
        if (to ~ /^(smr_)?config[.][a-z]+[.]/) { sub(/^(smr_)?config[.]/, "", to); sub(/[.]/, "_config.", to) }   # config.track.mode
        if (to ~ /[.]/ && !(to in block)) to = "smr_" to   # is smr_track_config.mode
        if (to ~ /^E_/) to = "SMR_" to   # E_INPUT is SMR_E_INPUT
        if ((to in block) && block[to] != own) out = out "<a href=\"#" to "\">" word "</a>"
        else if ((to in block) && to ~ /[.]/) out = out "<a href=\"#" to "\">" word "</a>"
        else out = out escape(word)
    }
    return out escape(text)
}

# Notes that this block declares a name; the first one counts.
function declare(name, k) { if (name != "" && !(name in block)) { block[name] = k; names[k] = names[k] " " name } }

function find_names(k,    i, line, depth, name, list) {
    depth = 0; name = ""; list = 0
    for (i = code[k]; i <= last[k]; i++) {
        line = text[i]
        if (line ~ /^[ \t]*(\/\*|\*)/ && line !~ /\*\/ *[a-z]/) continue
        if (line ~ /^#define/) { split(line, part, /[ (]/); declare(part[2], k); continue }
        if (depth == 0 && match(line, /^(typedef )?(struct|enum) [a-z_0-9]+/)) { sub(/^typedef /, "", line); split(line, part, / /); name = part[2]; declare(name, k); line = text[i] }
        if (depth == 0 && line ~ /^(typedef )?enum/) list = 1
        if (depth == 0 && match(line, /\(\*[a-z_0-9]+\)/) && line ~ /^typedef/) declare(substr(line, RSTART + 2, RLENGTH - 3), k)
        else if (depth == 0 && line ~ /^[a-z]/ && line !~ /^(typedef|enum)/ && match(line, /[a-z_0-9]+\(/)) declare(substr(line, RSTART, RLENGTH - 1), k)
        if (list) { rest = line; sub(/\/\*.*/, "", rest); while (match(rest, /SMR_[A-Z_0-9]+/)) { declare(substr(rest, RSTART, RLENGTH), k); rest = substr(rest, RSTART + RLENGTH) } }
        else if (depth == 1 && match(line, /^    [a-z].*;/)) {   # fields: "float a, b[3]; /* ... */"
            rest = line; sub(/;.*/, "", rest); sub(/^ *(const )?(unsigned char|void|[a-z_0-9]+) /, "", rest)
            n = split(rest, part, /,/)
            for (j = 1; j <= n; j++) if (match(part[j], /[a-z_][a-z_0-9]*/)) { declare(name "." substr(part[j], RSTART, RLENGTH), k); fields[i] = fields[i] "<a id=\"" name "." substr(part[j], RSTART, RLENGTH) "\"></a>" }
        }
        depth += gsub(/{/, "{", line) - gsub(/}/, "}", line)
    }
}

# The comment in front of a declaration, as paragraphs; what stands at the start of a line after a full stop begins one.
function prose(k,    i, line, out) {
    out = "<p>"
    for (i = first[k]; i < code[k]; i++) {
        line = text[i]; sub(/ ?\*\/$/, "", line); sub(/^\/\* ?/, "", line); sub(/^ \* ?/, "", line)
        if (line ~ /^SPDX/) continue
        if (line ~ /^Errors:/) out = out "</p><p class=e>"
        out = out linked(line, k) "\n"
    }
    return out "</p>"
}

function source(k,    i, line, at, out) {
    out = ""
    for (i = code[k]; i <= last[k]; i++) {
        line = text[i]; at = index(line, "/*"); out = out fields[i]
        if (line ~ /^ +\*/ || line ~ /^ +\/\*/) out = out "<i>" linked(line, k) "</i>\n"
        else if (at) out = out linked(substr(line, 1, at - 1), k) "<i>" linked(substr(line, at), k) "</i>\n"
        else out = out linked(line, k) "\n"
    }
    return out
}

function anchors(k,    n, i, part, out) {
    out = ""; n = split(names[k], part, / /)
    for (i = 1; i <= n; i++) if (part[i] != "" && part[i] !~ /[.]/) out = out "<a id=\"" part[i] "\"></a>"
    return out
}

{ text[NR] = $0 }

END {
    # Blocks end at an empty line outside of braces and comments.
    k = 0; depth = 0; inside = 0; open = 0
    for (i = 1; i <= NR; i++) {
        line = text[i]
        if (!open && line == "") continue
        if (!open) { open = 1; first[++k] = i; code[k] = 0 }
        if (line ~ /^\/[*] ----------/) { open = 0; last[k] = i; code[k] = i + 1; continue }   # a heading
        comment = inside || line ~ /^\/\*/
        if (line ~ /^\/\*/ && line !~ /\*\//) inside = 1
        else if (inside && line ~ /\*\//) inside = 0
        if (!comment && !code[k]) code[k] = i
        bare = line; gsub(/\/\*.*/, "", bare)
        if (!comment) depth += gsub(/{/, "{", bare) - gsub(/}/, "}", bare)
        last[k] = i
        if (line ~ /^extern "C"/) depth = 0
        if (text[i + 1] == "" && depth <= 0 && !inside) { open = 0; depth = 0; if (!code[k]) code[k] = i + 1 }
    }
    for (i = 1; i <= k; i++) find_names(i)
    for (i = 1; i <= NR; i++) if (match(text[i], /VERSION_(MAJOR|MINOR|PATCH) /)) version = version (version == "" ? "" : ".") substr(text[i], RSTART + RLENGTH)
    print "<!DOCTYPE html>\n<html lang=en><meta charset=utf-8><meta name=viewport content=\"width=device-width\">"
    print "<title>smr " version ": interface</title>\n<style>"
    print "body{margin:0;font:16px/1.45 sans-serif;color:#1a1a1a;background:#fff;display:grid;grid-template-columns:19em minmax(0,1fr)}"
    print "nav{position:sticky;top:0;height:100vh;overflow:auto;padding:1em;box-sizing:border-box;font-size:13px;border-right:1px solid #bbb}"
    print "nav a{display:block;overflow:hidden;text-overflow:ellipsis}nav b a{margin-top:.9em}main{max-width:74em;padding:1em 2em}"
    print "h2{margin:2em 0 .5em;border-bottom:2px solid #1a1a1a}h3{margin:1.5em 0 0}section{margin:1.6em 0}p{margin:.2em 0;white-space:pre-line}"
    print "pre{margin:.4em 0;padding:.6em .8em;background:#f3f3f0;border-left:3px solid #345;overflow-x:auto;font-size:13px;line-height:1.4}"
    print "a{color:#14539a;text-decoration:none}a:hover{text-decoration:underline}i{color:#5a5a52;font-style:normal}.e{color:#5b2b2b}"
    print "a[id]{scroll-margin-top:4em}@media(max-width:60em){body{display:block}nav{position:static;height:auto}}@media print{nav{display:none}}</style>"
    body = ""; index_ = ""
    for (i = 1; i <= k; i++) {
        line = text[first[i]]
        if (line ~ /^(#include|#ifdef __cpl|#endif|extern|})/) continue
        if (i == 1) last[i] = code[i] - 1   # the guard
        if (line ~ /^\/[*] ----------/) {
            title = line; sub(/^[^0-9]*/, "", title); sub(/ \*\/$/, "", title); id = "section" title + 0
            body = body "<h2 id=" id ">" escape(title) "</h2>\n"; index_ = index_ "<b><a href=\"#" id "\">" escape(title) "</a></b>\n"
            continue
        }
        if (line ~ /^\/[*] ---- /) { title = substr(line, 9); sub(/ -+ \*\/$/, "", title); body = body "<h3>" escape(title) "</h3>\n"; continue }
        body = body "<section>" anchors(i) (code[i] > first[i] ? prose(i) : "") (code[i] <= last[i] ? "<pre>" source(i) "</pre>" : "") "</section>\n"
        n = split(names[i], part, / /)
        for (j = 1; j <= n; j++) if (part[j] != "" && part[j] !~ /\./ && (part[j] ~ /^smr_/ || text[code[i]] ~ /^#define/)) index_ = index_ "<a href=\"#" part[j] "\">" part[j] "</a>\n"
    }
    print "<nav><b>smr " version "</b>\n" index_ "</nav>\n<main><h1>smr " version ": the interface</h1>\n" body "</main></html>"
}' "$1"
