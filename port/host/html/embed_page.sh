#!/bin/sh
# embed_page: a page as C, NAME_page.html with its parts, cut in two where the data go.
# SPDX-License-Identifier: MIT
# usage: embed_page.sh NAME_page.html >OUT.c       Needs awk and od only.
set -eu
page=$1
folder=$(dirname "$page")
name=$(basename "$page" .html)

# The page's lines; "@include FILE@" is a file beside it, without what its first lines say to those who read the source.
expand() {
    awk -v folder="$folder" '
        /^@include [a-z_0-9.]+@$/ {
            name = $2; sub(/@$/, "", name); name = folder "/" name
            while ((got = (getline line < name)) > 0) print line
            if (got < 0) { print "embed_page: no " name > "/dev/stderr"; exit 1 }
            close(name); next
        }
        { print }' "$page"
}

array() { # name: standard input as an array of bytes
    echo "const unsigned char $1[] = {"
    od -An -v -tu1 | sed 's/  */,/g; s/^,//; s/$/,/'
    echo "};"
    echo "const size_t $1_bytes = sizeof $1;"
}

echo '/* Made by embed_page.sh. */'
echo '#include <stddef.h>'
expand | awk '/^@data@$/ { exit } { print }' | array "host_${name}_head"
expand | awk 'behind { print } /^@data@$/ { behind = 1 }' | array "host_${name}_tail"
