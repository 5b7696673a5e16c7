# write.awk: docs/RESULTS.md from the list of keys, its last edition and what was measured now.
# SPDX-License-Identifier: MIT
# usage: awk -v command=... -v date=... -v commit=... -v machine=... -v load=... -f write.awk LIST OLD NEW
#   NEW: "key<TAB>value" lines. What is not in NEW keeps its value and its run from OLD.
function cell(n) { return field[n] }
function cells(line,   n, i) {
    n = split(line, field, "|")
    for (i = 1; i <= n; i++) gsub(/^ +| +$/, "", field[i])
    return n
}
FILENAME != last { last = FILENAME; file++ }
file == 1 && /^\* / {
    n = split(substr($0, 3), part, "; ")
    section[++sections] = part[1]
    title[sections] = part[2]
    how[sections] = part[3]
    for (i = 4; i <= n; i++) how[sections] = how[sections] "; " part[i]
    next
}
file == 1 && /^[^#*]/ {
    at = index($0, "; ")
    row[++rows] = section[sections] "." substr($0, 1, at - 1)
    what[row[rows]] = substr($0, at + 2)
    sub(/ <- .*/, "", what[row[rows]])
    of[rows] = sections
    next
}
file == 2 && /^\| [0-9]+ \| / { cells($0); run[cell(2) + 0] = $0; next }
file == 2 && /^\| `/ {
    cells($0)
    key = cell(2)
    gsub(/`/, "", key)
    if (cell(4) != "-") { value[key] = cell(4); by[key] = cell(5) }
    next
}
file == 3 {
    at = index($0, "\t")
    key = substr($0, 1, at - 1)
    if (!(key in what)) { print "results: " key " is not in list.txt" > "/dev/stderr"; bad = 1; next }
    fresh[key] = substr($0, at + 1)
}
END {
    if (bad) exit 1
    for (i = 1; i <= rows; i++) if (!(row[i] in fresh) && (row[i] in value)) {
        used[by[row[i]]] = 1
        if (by[row[i]] + 0 > most) most = by[row[i]] + 0
    }
    most++
    print "# smr: results"
    print ""
    print "`make results` writes this page; `make results-short` measures only results that take seconds. Other documents name"
    print "a result by its key; [README](../README.md) has a table of some results. A distance is in mm from one surface to the"
    print "triangles of another; mean distances integrate over the area unless the row names vertices. \"to\" means from the"
    print "model to the target or the truth, \"from\" the opposite direction. A surface error is a mean distance of surfaces; a"
    print "vertex error is the mean distance of vertices to their true places. Times depend on the machine and its load."
    print "[TESTING](TESTING.md) describes the experiments."
    print ""
    print "| run | date | commit | machine | command |"
    print "|---:|---|---|---|---|"
    for (i = 1; i < most; i++) if (i in used) print run[i]
    print "| " most " | " date " | " commit " | " machine " | " command " |"
    for (i = 1; i <= rows; i++) {
        if (of[i] != of[i - 1]) {
            s = of[i]
            print "\n<a id=\"" section[s] "\"></a>\n\n## " title[s] "\n\n" how[s] ".\n"
            print "| key | what | result | run |"
            print "|---|---|---:|---:|"
        }
        key = row[i]
        if (key in fresh) print "| `" key "` | " what[key] " | " fresh[key] " | " most " |"
        else if (key in value) print "| `" key "` | " what[key] " | " value[key] " | " by[key] " |"
        else print "| `" key "` | " what[key] " | - | - |"
    }
}
