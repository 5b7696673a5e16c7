# judge.awk: what the rows of many runs show about verdicts.
# SPDX-License-Identifier: MIT
# usage: awk -f judge.awk RUNS     lines "seed kind bone hopeless image overlap good surface vertex spearmanX ratioX", of
# which X is empty where it is unknown. Prints figures of the even and of the odd seeds, and a line for each kind.
function sort(list, n,   i, k, x) {
    for (i = 2; i <= n; i++) {
        x = list[i]
        for (k = i - 1; k > 0 && list[k] > x; k--) list[k + 1] = list[k]
        list[k + 1] = x
    }
}
# Clopper and Pearson: the largest share p for which k or fewer of n are not less likely than 5 %.
function upper(k, n,   low, high, p, i, j, sum) {
    if (n == 0 || k >= n) return 1
    high = 1
    for (i = 0; i < 60; i++) {
        p = (low + high) / 2
        sum = 0
        for (j = 0; j <= k; j++) sum += exp(log_of[n] - log_of[j] - log_of[n - j] + j * log(p) + (n - j) * log(1 - p))
        if (sum > 0.05) low = p
        else high = p
    }
    return (low + high) / 2
}
function count(half, by, error) {
    far[half, by] += error > 3
    far_good[half, by] += error > 3 && good
    near[half, by] += error < 1
    near_not[half, by] += error < 1 && !good
}
BEGIN { for (i = 1; i <= 2000; i++) log_of[i] = log_of[i - 1] + log(i) }
{
    half = $1 % 2 ? "odd" : "even"
    good = $7
    surface = $4 || $8 == "" || $8 < 0 ? 1e9 : $8 + 0
    vertex = surface < 1e9 && $9 >= 0 ? $9 + 0 : surface
    count(half, "surface", surface)
    count(half, "vertex", vertex)
    spearman = substr($10, 9)
    ratio = substr($11, 6)
    if (!$4 && $9 >= 0 && ratio != "") { ratios[half]++; ratios_in[half] += ratio >= 0.7 && ratio <= 1.5 }
    if (!$4 && $9 >= 0 && spearman != "" && ($5 || $6 < 0.95)) ranks[half, ++n_ranks[half]] = spearman + 0
    n_kind[$2]++
    good_kind[$2] += good
}
END {
    print "even.none_of_58", upper(0, 58)
    for (h = 0; h < 2; h++) {
        half = h ? "odd" : "even"
        for (b = 0; b < 2; b++) {
            by = b ? "vertex" : "surface"
            printf "%s.%s_far %d\n%s.%s_far_good %d\n%s.%s_far_most %.4f\n", half, by, far[half, by], half, by,
                far_good[half, by], half, by, 100 * upper(far_good[half, by], far[half, by])
            printf "%s.%s_near %d\n%s.%s_near_not %d\n%s.%s_near_most %.4f\n", half, by, near[half, by], half, by,
                near_not[half, by], half, by, 100 * upper(near_not[half, by], near[half, by])
        }
        for (i = 1; i <= n_ranks[half]; i++) list[i] = ranks[half, i]
        sort(list, n_ranks[half])
        printf "%s.spearman %.2f\n%s.ratios %d\n%s.ratios_in %.2f\n", half, list[int(n_ranks[half] / 2) + 1], half,
            ratios[half], half, 100 * ratios_in[half] / (ratios[half] ? ratios[half] : 1)
    }
    for (k in n_kind) printf "  %-20s %4d runs, %4d good\n", k, n_kind[k], good_kind[k]
}
