#!/bin/sh
# check_header: smr.h compiles alone as C99, C11 and C++, its macros serve static storage, and a caller of 0.2 is rewritten.
# SPDX-License-Identifier: MIT
set -u
. tests/checks.inc
strict='-Wall -Wextra -Wconversion -Wshadow -Wcast-qual -pedantic -pedantic-errors -Werror -fsyntax-only -Iinclude'
printf '#include <smr.h>\nint smr_check_header;\n' >"$tmp/alone.c"
cp "$tmp/alone.c" "$tmp/alone.cpp"
{
    cat "$tmp/alone.c"
    echo 'static _Alignas(SMR_ALIGN) unsigned char arena[SMR_ARENA_BYTES(1000, 2000, 3, 2, 500, SMR_METHOD_POLAR)];'
    echo 'unsigned char *smr_check_arena(void); unsigned char *smr_check_arena(void) { return arena; }'
} >"$tmp/static.c"
cxx=
case $cc in *clang*) set -- clang++ g++ c++ ;; *) set -- g++ c++ clang++ ;; esac
for candidate in ${CXX:-} "$@"; do if [ -z "$cxx" ] && have "$candidate"; then cxx=$candidate; fi; done
# Compiler, file and flags; C++98 has no long long in its text, but every compiler has it.
while read -r compiler file flags; do
    [ -n "$compiler" ] || continue
    # shellcheck disable=SC2086
    check "$file $flags" $compiler $strict $flags "$tmp/$file"
done <<END
$cc alone.c -std=c99
$cc alone.c -std=c11
$cc static.c -std=c11
$cxx${cxx:+ alone.cpp -std=c++98 -Wno-long-long}
$cxx${cxx:+ alone.cpp -std=c++11}
$cxx${cxx:+ alone.cpp -std=c++17}
END
[ -n "$cxx" ] || skip 'C++' 'needs g++ or clang++'
# A caller of 0.2, rewritten once and twice.
cat >"$tmp/old.c" <<'END'
#include <smr.h>
int smr_check_old(smr *s, const smr_mesh *mesh, unsigned char *to, size_t *bytes);
int smr_check_old(smr *s, const smr_mesh *mesh, unsigned char *to, size_t *bytes)
{
    smr_config config = smr_config_default(), *my_config = &config;
    smr_align_config align = smr_align_config_default();
    smr_tick_report report;
    smr_verdict verdict;
    config.basic.n_target_vertices = mesh->n_vertices;
    config.track.mode = SMR_TRACK_RECOVER;
    my_config->track_mm = my_config->contact > 0.0f ? config.contact.gap_mm : config.forces.box_max[0];
    if (config.track.mode) config.contact.volume = config.dynamics.mode ? 0.0f : 1.0f;
    align.iterations = 10;
    *bytes = align.iterations + SMR_ARENA_TRACK_BYTES(mesh->n_vertices, 1u) + SMR_SAVE_TRACK_BYTES(mesh->n_vertices);
    if (smr_tick(s, 0, &report) != SMR_OK || report.settled || report.done || report.n_taken == report.n_forces) return 1;
    if (smr_get_verdict(s, SMR_ALL, &verdict) != SMR_OK || (verdict.reasons & SMR_REASON_LITTLE_VISIBLE) != 0) return 2;
    return verdict.seen_share < verdict.likeness || smr_get_visible(s, 0, to) != SMR_OK;
}
END
sed -E -f port/package/rename_0_2.sed "$tmp/old.c" >"$tmp/new.c"
sed -E -f port/package/rename_0_2.sed "$tmp/new.c" >"$tmp/again.c"
# shellcheck disable=SC2086
check 'a caller of 0.2, rewritten' $cc $strict -std=c11 "$tmp/new.c"
check 'rewritten twice: the same' cmp "$tmp/new.c" "$tmp/again.c"
finish
