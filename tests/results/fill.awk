# fill.awk: fills a template with results.
# SPDX-License-Identifier: MIT
# usage: awk -f fill.awk docs/RESULTS.md TEMPLATE        {key} becomes the result, {key#} its number without the unit
FILENAME == ARGV[1] {
    if ($0 !~ /^\| `/) next
    split($0, field, "|")
    key = field[2]
    gsub(/[` ]/, "", key)
    gsub(/^ +| +$/, "", field[4])
    value[key] = field[4]
    next
}
/^<!--/ && !begun { next }
{
    begun = 1
    out = ""
    while (match($0, /\{[a-z0-9_.A-Z]+#?\}/)) {
        key = substr($0, RSTART + 1, RLENGTH - 2)
        bare = sub(/#$/, "", key)
        if (!(key in value)) { print "fill: no result " key > "/dev/stderr"; bad = 1 }
        text = value[key]
        if (bare) sub(/ [a-zA-Z%].*$/, "", text)
        out = out substr($0, 1, RSTART - 1) text
        $0 = substr($0, RSTART + RLENGTH)
    }
    print out $0
}
END { exit bad }
