# report.awk: figures of a registration and a line of a table, from the "path value" lines that json.awk makes of a
# report.json.
# SPDX-License-Identifier: MIT
# usage: awk -v row=NAME -v status=N -f report.awk       "figure value" lines, distances in mm; "table ..." to be shown
function tell(name, value) { if (value ~ /^-?[0-9]/) print name, value }
function number(value) { return value ~ /^[0-9]/ ? value : -1 }
function larger(a, b) { return a + 0 > b + 0 ? a : b }
/^per_structure\./ {
    split($1, part, ".")
    key = substr($1, length("per_structure." part[2]) + 2)
    if (key == "name") { n++; name[n] = $2 }
    s[n, key] = $2
    next
}
{ v[$1] = substr($0, length($1) + 2) }
END {
    to = v["distance_mm.whole_model_to_target.mean"]
    from = v["distance_mm.target_to_model.mean"]
    for (i = 1; i <= n; i++) {
        a = s[i, "distance_mm.whole_model_to_target.mean"]
        b = s[i, "distance_mm.target_to_model.mean"]
        if (a + 0 > worst_to + 0) { worst_to = a; worst_to_name = name[i] }
        if (b + 0 > worst_from + 0) { worst_from = b; worst_from_name = name[i] }
        tell("to_" name[i], a)
        print "good_" name[i], s[i, "verdict"] == "good"
        if (s[i, "volume_ratio_asked"] > 0) {
            off = s[i, "volume_ratio"] / s[i, "volume_ratio_asked"] - 1
            volume_off = larger(volume_off, off < 0 ? -off : off)
        }
    }
    tell("status", status)
    print "good", v["verdict"] == "good"
    print "level", v["verdict"] == "good" ? 0 : v["verdict"] == "look" ? 1 : 2
    tell("probability", v["probability"])
    tell("to", to)
    tell("from", from)
    if (to != "" && from != "") tell("mean", larger(to, from))
    tell("worst_to", worst_to)
    tell("worst_from", worst_from)
    print "worst_to_name", worst_to_name
    print "worst_from_name", worst_from_name
    tell("by_vertex", v["truth.vertex_to_vertex_mm.mean"])
    tell("folds", v["folds"])
    tell("goals", 100 * v["matched_share"])
    tell("structures", n)
    tell("expected", v["expected_error_mm"])
    tell("deepest", v["contact.deepest_mm"])
    tell("overlap", v["contact.volume_mm3"])
    tell("marks_off", v["landmark_goals.residual_max_mm"])
    if (volume_off != "") tell("volume_off", volume_off + 0)
    gsub(/ /, "_", v["start_kind"])
    print "started_" v["start_kind"], 1
    for (i = 0; i < 12; i++) m[i] = v["start_pose." i]
    d = m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) + m[2] * (m[4] * m[9] - m[5] * m[8])
    if (d > 0) tell("scale", exp(log(d) / 3))
    vertex = v["truth.vertex_to_vertex_mm.mean"]
    printf "table   %-24s to %7.3f from %7.3f worst %7.3f %7.3f vertex %6.2f folds %3d goals %5.1f%% %6.2f s  %s %s\n", row,
        number(to), number(from), worst_to, worst_from, number(vertex), v["folds"], 100 * v["matched_share"],
        v["time_s.total"], worst_to_name, v["verdict"] == "good" ? "" : "(" v["verdict"] ")"
}
