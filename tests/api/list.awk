# list.awk: the interface of public headers, as lines with places for numbers, and a C source that gives the numbers.
# SPDX-License-Identifier: MIT
# usage: cc -E -dD HEADER | awk -v source=FILE.c -f list.awk      The array smr_api_K has as many bytes as number K, and one.

function number(expression) { print "char smr_api_" ++numbers "[(size_t)(" expression ") + 1u];" >source; return "@" numbers "@" }
function trim(text) { gsub(/[ \t]+/, " ", text); gsub(/^ | $/, "", text); gsub(/\( /, "(", text); return text }

# "const float *xyz, weight[3]" and "void (*call)(int a, int b)": a line for each member.
function members(owner, text,    n, i, part, kind, name, place) {
    n = text ~ /\(/ ? 1 : split(text, part, /,/)
    if (n == 1) part[1] = text
    for (i = 1; i <= n; i++) {
        if (part[i] ~ /\(\*/) { name = part[i]; sub(/^.*\(\*/, "", name); sub(/\).*/, "", name); kind = part[i] }
        else {
            match(part[i], /[a-z_A-Z0-9]+ *(\[[^]]*\])*$/)
            name = substr(part[i], RSTART, RLENGTH); sub(/ *\[.*/, "", name)
            if (i == 1) { first = substr(part[1], 1, RSTART - 1); gsub(/\*| +$/, "", first) }
            kind = i == 1 ? part[1] : first " " trim(part[i])
        }
        place = number("offsetof(" owner ", " name ")")
        print "field " owner "." name " at " place ", " number("sizeof ((" owner " *)0)->" name) " bytes: " trim(kind)
    }
}
function statement(text,    body, head, n, i, part, name) {
    text = trim(text)
    if (text == "" || text ~ /^extern "C"$/) return
    if (text !~ /{/) { print (text ~ /^typedef/ ? "type " : "call ") text; return }
    head = body = text
    sub(/{.*/, "", head); sub(/^[^{]*{/, "", body); sub(/}[^}]*$/, "", body)
    if (head ~ /enum/) {
        n = split(body, part, /,/)
        for (i = 1; i <= n; i++) { name = trim(part[i]); sub(/ *=.*/, "", name)
            if (name != "") print "value " name " = " number(name " + 1000") " - 1000" }
        return
    }
    name = trim(head); sub(/^(typedef )?struct /, "", name)
    print "struct " name ": " number("sizeof(" name ")") " bytes"
    n = split(body, part, /;/)
    for (i = 1; i <= n; i++) if (trim(part[i]) != "") members(name, trim(part[i]))
}
BEGIN { print "#include <smr_pthread.h>" >source }
/^# [0-9]+ "/ { own = $3 ~ /smr(_pthread)?\.h"$/; next }
!own { next }
# Versions change by themselves; bounds of sizes may become larger or smaller.
/^#define SMR_(VERSION_|SWAPPED_BYTES|H$|H |PTHREAD_H)/ { next }
/^#define [A-Z_0-9]+\(/ { sub(/\).*/, ")"); print "macro " substr($0, 9); next }
/^#define/ { print "macro " trim(substr($0, 9)); next }
/^#/ { next }
{
    for (i = 1; i <= length($0); i++) {
        c = substr($0, i, 1)
        depth += (c == "{") - (c == "}")
        if (c == ";" && depth == 0) { statement(text); text = "" } else text = text c
    }
    text = text " "
}
END {
    n = split(cookies, part, / /) # TAG:STRUCT
    for (i = 1; i <= n; i++) { split(part[i], cookie, ":")
        print "cookie of " cookie[2] ": " cookie[1] " " number("SMR_COOKIE(0, " cookie[2] ")") }
}
