# json.awk: "path value" for every number and word of a report.json, one member a line as smr writes it.
# SPDX-License-Identifier: MIT
# The path joins keys by dots; members of an array are counted from 0.
{
    line = $0
    sub(/^ +/, "", line)
    sub(/,$/, "", line)
    key = ""
    if (match(line, /^"[^"]*": /)) {
        key = substr(line, 2, RLENGTH - 4)
        line = substr(line, RLENGTH + 1)
    } else if (depth > 0 && array[depth] && line !~ /^[]}]/) {
        key = count[depth]++
    }
    if (line ~ /^[[{]$/) {
        depth++
        array[depth] = line == "["
        count[depth] = 0
        path[depth] = depth == 1 ? "" : path[depth - 1] key "."
    } else if (line ~ /^[]}]$/) {
        depth--
    } else if (line !~ /^[[{]/) {
        gsub(/"/, "", line)
        print path[depth] key, line
    }
}
