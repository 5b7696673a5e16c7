# table.awk: the table of instructions, a line for each figure of all boards and cases, from and to single rows.
# SPDX-License-Identifier: MIT
# usage: awk -v pack=1 -f table.awk ROWS >TABLE      awk -f table.awk TABLE >ROWS      single rows stay as they are
# A row: board; kind; case, step; name; smallest; largest. A line: kind; step; name, then "smallest largest" of each column.
function column(b, c) { return b "; " c }
BEGIN {
    n = split("m7 m55", board, " ") * split("surface rigid,surface polar,image rigid,image polar", of, ",")
    for (i = 0; i < n; i++) name[i + 1] = column(board[int(i / 4) + 1], of[i % 4 + 1])
}
/^#/ || (!pack && /^m[0-9]+; /) { print; next }
pack {
    split($0, part, "; ")
    step = part[3]; at = part[1] "; " of[1] # what has no case stands in the first one's column
    if (match(step, /^(surface|image) (rigid|polar)/)) {
        at = column(part[1], substr(step, 1, RLENGTH)); step = substr(step, RLENGTH + 1); sub(/^, /, "", step)
        if (step == "") step = "-"
    }
    line = part[2] "; " step "; " part[4]
    if (!(line in known)) { known[line] = 1; lines[++m] = line }
    value[line, at] = part[5] " " part[6]
    next
}
{
    split($0, part, "; ")
    for (i = 1; i <= n; i++) if (part[3 + i] != "-") {
        split(part[3 + i], v, " "); split(name[i], w, "; ")
        step = part[2] == "-" ? w[2] : part[2] ~ /^step/ ? w[2] ", " part[2] : part[2]
        print w[1] "; " part[1] "; " step "; " part[3] "; " v[1] "; " v[2]
    }
}
END {
    for (k = 1; k <= m; k++) {
        line = lines[k]
        for (i = 1; i <= n; i++) line = line "; " ((lines[k], name[i]) in value ? value[lines[k], name[i]] : "-")
        print line
    }
}
