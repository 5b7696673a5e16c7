#!/bin/sh
# `smr COMMAND --help`, the man pages and the completion of shells: every option of every command, told and well-formed.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
pages=$(dirname "$SMR")/help_pages
mkdir man
"$pages" >records.txt
check "the pages are written" awk -v dir=man -f "$top/tests/docs/help_pages.awk" records.txt
sed -n 's/^option\t//p' records.txt >list.txt # command, option, value, sentence
"$SMR" >/dev/null 2>said.txt
commands=$(sed -n 's/.*expected //p' said.txt | tr -d ',' | tr ' ' '\n' | grep '^[a-z]*$' | grep -v '^or$')
check "the program names its commands" [ "$(echo "$commands" | wc -l)" -ge 11 ]

for command in $commands; do
    check "$command --help" sh -c "'$SMR' $command --help >$command.txt"
    check "$command: its own help" grep -q "^smr $command: [a-z]" $command.txt
    check "$command: a man page" [ -f man/smr-$command.1 ]
    check "$command: in the overview of the man pages" grep -q "smr.-$command (1)" man/smr.1
    lost=
    for option in $(awk -F '\t' -v c="$command" '$1 == c { print $2 }' list.txt); do
        grep -q -e "^  $option\( .*\)* *[a-z(]" $command.txt || lost="$lost $option"
        grep -qF -e "\fB$(echo "$option" | sed 's/-/\\-/g')\fR" man/smr-$command.1 || lost="$lost $option(man)"
    done
    check "$command: help and page have all its options:$lost" [ -z "$lost" ]
done
untold=$(awk -F '\t' '$4 == "" { print $1, $2 }' list.txt)
check "every option has a sentence in option_text.c: $untold" [ -z "$untold" ]
check "lines of help are at most 110 characters" sh -c "! grep -n '^.\{111,\}' ./*.txt | grep -v -e list.txt -e records.txt -e said.txt -e '^./[a-z]*.txt:[0-9]*:\(usage:\|      \)'"
check "help of all" has_status 0 "$SMR" --help && mv out.txt all.txt
refused "help of what is no command" "^smr: align: command: expected register" "$SMR" align --help
lost=
for option in $(cut -f 2 list.txt | sort -u); do grep -q -e "$option\([^a-z-]\|\$\)" all.txt || lost="$lost $option"; done
check "which has all options:$lost" [ -z "$lost" ]
check "the version" sh -c "'$SMR' --version | grep -q '^smr [0-9]*\.[0-9]*\.[0-9]*\$'"
check "the pages have it" grep -q "$("$SMR" --version)" man/smr.1

if command -v mandoc >/dev/null; then
    check "mandoc has nothing against the pages" sh -c 'mandoc -Tlint -Wwarning man/*.1 >lint.txt 2>&1; cat lint.txt; [ ! -s lint.txt ]'
else skip "mandoc has nothing against the pages" "no mandoc"; fi
if command -v groff >/dev/null; then
    check "groff has nothing against the pages" sh -c 'for page in man/*.1; do groff -man -ww -z -Tutf8 $page; done >lint.txt 2>&1; cat lint.txt; [ ! -s lint.txt ]'
    check "a page reads as it should" sh -c "groff -man -Tascii -P-cbou man/smr-register.1 2>/dev/null | grep -q -e '^ *--budget-ms MS'"
else skip "groff has nothing against the pages" "no groff"; fi

# bash_says WORD...: what bash offers for the last word, in a line.
bash_says() {
    bash -c '. man/smr.bash; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _smr; IFS=" "; echo "${COMPREPLY[*]}"' bash "$@"
}
offers() { # offers WANTED WORD...: exactly this
    wanted=$1
    shift
    check "bash: $* -> $wanted" [ "$(bash_says "$@")" = "$wanted" ]
}
if command -v bash >/dev/null && bash -c 'type mapfile compgen' >/dev/null 2>&1; then
    mkdir folder && : >femur.ply && : >folder/inner.ply
    offers 'register replay' smr re
    offers '--version' smr --v
    offers '--help --version' smr --
    offers 'none rigid similarity parts' smr register --align ''
    offers 'similarity' smr register --model a.ply --align s
    offers '--budget-ms' smr register --model a.ply --budget-m
    offers 'femur.ply' smr register --model fem
    offers 'femur.ply' smr register --model a.ply b.ply fem
    offers 'folder' smr carry --result fo
    offers '' smr register --ticks ''
    offers '--mirror-model --mirror-target' smr register --quiet --mir
    offers '--mirror-model --mirror-target' smr register --ticks 3 --mir
    offers 'femur.ply' smr info fem
    offers '' smr nothing ''
    check "bash: options come after a value" [ "$(bash_says smr build -o a.smr '' | tr ' ' '\n' | grep -c -e '^--')" -ge 5 ]
    for command in $commands; do
        want=$(awk -F '\t' -v c="$command" '$1 == c { print $2 }' list.txt | sort | tr '\n' ' ')
        got=$(bash_says smr "$command" - | tr ' ' '\n' | grep -v '^--help$' | sort | tr '\n' ' ')
        check "bash: $command has all its options" [ -n "$want" -a "$want" = "$got" ]
    done
else skip "bash completes" "no bash with mapfile"; fi

if command -v zsh >/dev/null; then
    zsh_says() { # zsh_says WORD...: what its completion would be told
        zsh -fc '_arguments() { print -rl -- "$@" }; _describe() { eval "print -rl -- \${$2}" }
            _files() { }; words=("$@"); CURRENT=$#; . ./man/_smr' zsh "$@"
    }
    zsh_says smr '' >zsh.txt 2>&1
    check "zsh: commands with their purposes" grep -q '^register:deform a model' zsh.txt
    zsh_says smr register '' >zsh.txt 2>&1
    check "zsh: words" grep -q -e '^--align\[.*:none|rigid|similarity|parts:(none rigid similarity parts)$' zsh.txt
    check "zsh: files" grep -q -e '^--model\[.*:\*-\*:FILE...:_files$' zsh.txt
    check "zsh: all options of register" [ "$(grep -c -e '^-' zsh.txt)" -eq "$(($(grep -c '^register' list.txt) + 1))" ]
else skip "zsh completes" "no zsh"; fi
finish
