# judge.awk: what the rows of many runs show about verdicts.
# SPDX-License-Identifier: MIT
# usage: awk -f judge.awk RUNS     lines "seed kind bone hopeless image overlap good surface vertex spearmanX ratioX family
# level probability acrossX", of which X is empty where it is unknown; level 0: good, 1: look, 2: failed. Even seeds have
# the bones that the rules were fitted to, odd ones the others. Prints figures of both, and a line for each family.
function sort(list, n,   i, k, x) {
    for (i = 2; i <= n; i++) {
        x = list[i]
        for (k = i - 1; k > 0 && list[k] > x; k--) list[k + 1] = list[k]
        list[k + 1] = x
    }
}
# Wilson's bounds, %, of the share k of n at 95 %: sign -1 for the lower one, 1 for the upper one.
function wilson(k, n, sign,   z, p) {
    if (n == 0) return sign < 0 ? 0 : 100
    z = 1.96
    p = k / n
    p = (p + z * z / (2 * n) + sign * z * sqrt(p * (1 - p) / n + z * z / (4 * n * n))) / (1 + z * z / n)
    return 100 * (p < 0 ? 0 : p > 1 ? 1 : p)
}
function count(class, probability,   of, level) {
    of = half SUBSEP class
    n[of]++
    n_family[of, $12]++
    for (level = 0; level < 3; level++)
        if ($13 == level) { called[of, level]++; called_family[of, $12, level]++ }
    for (i = 1; i <= steps; i++) if (probability >= step[i]) over[of, i]++
}
# A figure of the class: the share with the level as a mean over families, then count, pooled share's count and bounds.
function tell(half, class, level, word,   of, f, sum, families) {
    of = half SUBSEP class
    for (f in n_kind)
        if (n_family[of, f] > 0) { families++; sum += called_family[of, f, level] / n_family[of, f] }
    printf "%s.%s %d\n%s.%s_%s %d\n%s.%s_%s_mean %.2f\n%s.%s_%s_least %.2f\n%s.%s_%s_most %.2f\n", half, class, n[of],
        half, class, word, called[of, level], half, class, word, families ? 100 * sum / families : 0,
        half, class, word, wilson(called[of, level], n[of], -1), half, class, word, wilson(called[of, level], n[of], 1)
}
BEGIN { steps = split("0.05 0.2 0.35 0.5 0.7 0.8 0.9 0.95", step, " "); bins = split("0 0.05 0.3 0.8 0.95 1.01", bin, " ") }
{
    half = $1 % 2 ? "odd" : "even"
    vertex = !$4 && $9 >= 0
    lost = $8 == "" || $8 < 0
    other = $12 == "wrong_bone" || $12 == "mirrored"
    right = !lost && !other && $8 < 1 && (!vertex || $9 < 3)
    if (right) count("right", $14)
    if (lost || other || $8 > 2 || (vertex && $9 > 6)) count("wrong", $14)
    if (lost || $8 > 10 || (vertex && $9 > 20)) count("gross", $14)
    for (i = 1; i < bins; i++) if ($14 >= bin[i] && $14 < bin[i + 1]) { n_bin[half, i]++; right_bin[half, i] += right }
    spearman = substr($10, 9)
    ratio = substr($11, 6)
    if (!$4 && $9 >= 0 && ratio != "") { ratios[half]++; ratios_in[half] += ratio >= 0.7 && ratio <= 1.5 }
    if (!$4 && $9 >= 0 && spearman != "" && ($5 || $6 < 0.95)) ranks[half, ++n_ranks[half]] = spearman + 0
    across = substr($15, 7)
    if (!$4 && $9 >= 0 && $9 <= 20 && $8 <= 10 && ratio > 0) true_over[half, $12, ++n_true[half, $12]] = 1 / ratio
    if (!$4 && !other && $8 >= 0 && $8 <= 10 && $9 <= 20 && across != "") {
        acrosses[half]++
        across_in[half] += across >= 0.5 && across <= 2
    }
    n_kind[$12]++
    good_kind[$12] += $7
}
END {
    for (h = 0; h < 2; h++) {
        half = h ? "odd" : "even"
        tell(half, "right", 0, "good")
        tell(half, "right", 2, "failed")
        tell(half, "wrong", 0, "good")
        tell(half, "gross", 2, "failed")
        for (i = 1; i <= steps; i++)
            printf "%s.right_over_%d %.1f\n%s.wrong_over_%d %.1f\n", half, 100 * step[i],
                100 * over[half, "right", i] / (n[half, "right"] + !n[half, "right"]), half, 100 * step[i],
                100 * over[half, "wrong", i] / (n[half, "wrong"] + !n[half, "wrong"])
        for (i = 1; i < bins; i++)
            printf "%s.in_%d %d\n%s.right_in_%d %.0f\n", half, 100 * bin[i], n_bin[half, i], half, 100 * bin[i],
                100 * right_bin[half, i] / (n_bin[half, i] + !n_bin[half, i])
        m = n_ranks[half]
        for (i = 1; i <= m; i++) list[i] = ranks[half, i]
        sort(list, m)
        printf "%s.spearman %.2f\n%s.ratios %d\n%s.ratios_in %.2f\n", half, list[int(m / 2) + 1], half,
            ratios[half], half, 100 * ratios_in[half] / (ratios[half] ? ratios[half] : 1)
        low = 9
        high = p90 = 0
        for (k in n_kind) { # true over expected error of vertices
            m = n_true[half, k]
            if (m == 0) continue
            for (i = 1; i <= m; i++) list[i] = true_over[half, k, i]
            sort(list, m)
            middle = list[int((m + 1) / 2)]
            if (middle < low) low = middle
            if (middle > high) high = middle
            if (list[int(0.9 * m + 0.5)] > p90) p90 = list[int(0.9 * m + 0.5)]
        }
        printf "%s.true_least %.2f\n%s.true_most %.2f\n%s.true_p90 %.2f\n%s.across_in %.2f\n", half, low, half, high, half, p90,
            half, 100 * across_in[half] / (acrosses[half] ? acrosses[half] : 1)
    }
    for (k in n_kind) {
        printf "  %-12s %4d runs, %4d good", k, n_kind[k], good_kind[k]
        for (c = split("right wrong gross", class, " "); c > 0; c--)
            printf "; %s %d: %d %d %d", class[c], n_family["odd", class[c], k], called_family["odd", class[c], k, 0],
                called_family["odd", class[c], k, 1], called_family["odd", class[c], k, 2]
        print ""
    }
}
