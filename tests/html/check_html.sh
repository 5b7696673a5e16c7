#!/bin/sh
# check_html: pages of reports test themselves in a headless Chromium: a surface onto another, a small computed thigh,
# a moving target, many results.
# SPDX-License-Identifier: MIT
# usage: BUILD=... SMR=... check_html.sh      `make check-html`; 77 without a Chromium
# Pictures and what the pages said stay in BUILD/html.
set -u
cd "$(dirname "$0")/../.." || exit 1
SMR=${SMR:-build/smr}
out=${BUILD:-build}/html
browser=
for candidate in chromium chromium-browser google-chrome; do
    [ -n "$browser" ] || browser=$(command -v "$candidate" 2>/dev/null)
done
[ -n "$browser" ] || { echo 'skip: needs chromium'; exit 77; }
[ -x "$SMR" ] || { echo "not ok $SMR is built"; echo '0 passed, 1 failed, 0 skipped'; exit 1; }
rm -rf "$out"
mkdir -p "$out/profile" || exit 1
passed=0; failed=0
ok() { passed=$((passed + 1)); echo "ok $1"; }
not_ok() { failed=$((failed + 1)); echo "not ok $1"; }

# look PAGE NAME ARGUMENT...: the browser's own words go to NAME.err. Software drawing: no graphics card is needed.
look() {
    look_page=$1 look_name=$2
    shift 2
    timeout 100 "$browser" --headless=new --no-sandbox --disable-gpu-sandbox --use-gl=angle --use-angle=swiftshader \
        --enable-unsafe-swiftshader --disable-dev-shm-usage --no-first-run --disable-extensions --disable-background-networking \
        --user-data-dir="$out/profile" --window-size=1500,1000 --hide-scrollbars --enable-logging=stderr --log-level=0 \
        --virtual-time-budget=20000 "$@" "file://$(cd "$(dirname "$look_page")" && pwd)/$(basename "$look_page")" \
        >"$out/$look_name.out" 2>"$out/$look_name.err"
}

# test_page NAME PAGE CHECKS: page_selftest.js in a copy of the page, and that the browser had nothing to say.
test_page() {
    cp "$2" "$out/$1.html"
    { sed '/^<\/body>$/,$d' "$2" && echo '<script>' && cat tests/html/page_selftest.js && printf '</script>\n</body>\n</html>\n'; } >"$out/$1.test.html"
    look "$out/$1.test.html#selftest" "$1" --dump-dom
    grep -q '<title>selftest: passed, [0-9]* checks, 0 failed</title>' "$out/$1.out" && ok "$1: its tests" || {
        not_ok "$1: its tests"
        grep -oE '(^|>)not ok [^<]*|<title>[^<]*' "$out/$1.out" | head -n 20 | sed 's/^/#   /'
    }
    n=$(grep -cE '^(ok|not ok) |>ok ' "$out/$1.out")
    [ "$n" -ge "$3" ] && ok "$1: $n checks" || not_ok "$1: $n checks, at least $3 were expected"
    if grep -E 'CONSOLE' "$out/$1.err" >"$out/$1.console"; then
        not_ok "$1: nothing on the console"
        head -n 5 "$out/$1.console" | sed 's/^/#   /'
    else
        ok "$1: nothing on the console"
    fi
    look "$out/$1.html" "$1.picture" --screenshot="$out/$1.png"
    [ "$(wc -c <"$out/$1.png" 2>/dev/null || echo 0)" -gt 20000 ] && ok "$1: a picture" || not_ok "$1: a picture"
}

build_thigh() {
    "$SMR" phantom --small --quiet -o "$out/thigh" && "$SMR" register --quiet --html --accept look \
        --model "$out"/thigh/model/*.ply --reference "$out/thigh/mri_reference.mha" --target "$out/thigh/mri_patient.mha" \
        --landmarks "$out/thigh/landmarks_reference.mrk.json" "$out/thigh/landmarks_patient.mrk.json" \
        --truth "$out/thigh/truth" -o "$out/thigh/result"
}
if build_thigh >"$out/thigh.log" 2>&1; then test_page thigh "$out/thigh/result/report.html" 70
else not_ok "a small thigh: $(head -n 1 "$out/thigh.log")"; fi

# A femur of it onto the patient's: surfaces alone, with a name that would break a careless page.
odd='femur "<b>&'"'"'</script'
mkdir -p "$out/pair" "$out/to"
name=$(printf '%s' "$odd" | tr -d /)
cp "$out/thigh/model/femur.ply" "$out/pair/$name.ply"
cp "$out/thigh/truth/femur.ply" "$out/to/<img src=x onerror=alert(1)>.ply"
if "$SMR" register --quiet --html --accept look --align rigid --model "$out/pair/$name.ply" \
    --target "$out/to/<img src=x onerror=alert(1)>.ply" -o "$out/pair/result" >"$out/pair.log" 2>&1; then
    test_page pair "$out/pair/result/report.html" 50
else not_ok "a pair of surfaces: $(head -n 1 "$out/pair.log")"; fi
# An ellipsoid followed through frames that bend it, the last one far off: a jump.
mkdir -p "$out/frames"
awk_frame() { # AMOUNT: the vertices of an ASCII surface, moved
    awk -v by="$1" '/^element vertex/ { n = $3 } on && n-- > 0 { $1 += by * $3 * $3 / 4000; $2 += by } /^end_header/ { on = 1 } { print }'
}
blob_ply() { # an ellipsoid, its long axis along z
    awk 'BEGIN {
        n = 20; m = 30; pi = atan2(0, -1)
        printf "ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n", (n - 1) * m + 2
        printf "element face %d\nproperty list uchar int vertex_indices\nend_header\n", 2 * m * (n - 1)
        print "0 0 60"
        for (i = 1; i < n; i++) for (j = 0; j < m; j++) print 30 * sin(pi * i / n) * cos(2 * pi * j / m), 20 * sin(pi * i / n) * sin(2 * pi * j / m), 60 * cos(pi * i / n)
        print "0 0 -60"
        for (j = 0; j < m; j++) {
            k = (j + 1) % m; print 3, 0, 1 + j, 1 + k
            for (i = 1; i < n - 1; i++) { a = 1 + (i - 1) * m; print 3, a + j, a + m + j, a + m + k; print 3, a + j, a + m + k, a + k }
            print 3, (n - 1) * m + 1, 1 + (n - 2) * m + k, 1 + (n - 2) * m + j
        }
    }'
}
blob_ply >"$out/frames/$name.ply"
for i in 0 1 2 3 4 5 6 7; do awk_frame "$((i == 7 ? 45 : i))" <"$out/frames/$name.ply" >"$out/frames/<b>$i.ply"; done
if "$SMR" track --quiet --html --accept look --model "$out/frames/$name.ply" --frames "$out/frames/<b>"?.ply -o "$out/frames/result" >"$out/frames.log" 2>&1; then
    test_page frames "$out/frames/result/report.html" 50
else not_ok "a tracking run: $(head -n 1 "$out/frames.log")"; fi
mkdir -p "$out/many/none"
ln -s ../thigh/result "$out/many/thigh"
ln -s ../pair/result "$out/many/pair"
"$SMR" summary --quiet --html "$out/many/page.html" "$out"/many/thigh "$out"/many/pair "$out"/many/none >"$out/many.log" 2>&1
test_page cohort "$out/many/page.html" 9
rm -rf "$out/profile"
echo "$passed passed, $failed failed, 0 skipped"
[ "$failed" -eq 0 ]
