#!/bin/sh
# dist: the sources as an archive whose bytes do not depend on place, time, user or git; and the list of its parts.
# SPDX-License-Identifier: MIT
# usage: dist.sh archive NAME FILE.tar.gz     NAME is the folder in the archive; needs GNU tar and gzip
#        dist.sh sbom NAME FILE.tar.gz        that archive and its files in the form of SPDX 2.3, on standard output
# From the top directory. Files: what git tracks; in an unpacked archive all that .gitignore does not name. The time is that of the
# newest version in the CHANGELOG.
set -eu
export LC_ALL=C TZ=UTC0
umask 022
what=$1 name=$2 archive=$3
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
list() {
    if [ -e .git ] && git ls-files 2>/dev/null; then return; fi
    set --
    while read -r pattern; do
        case $pattern in
        /*/) set -- "$@" ! -path ".${pattern}*" ;;
        *) set -- "$@" ! -name "$pattern" ;;
        esac
    done <.gitignore
    find . -type f ! -path './.git/*' "$@" | sed 's|^\./||'
}
list | sort >"$tmp/list"
date=$(sed -n 's/^## \[[0-9.]*\] - \([0-9-]*\)$/\1/p' CHANGELOG.md | head -n 1)

archive() {
    tar=tar
    case $(tar --version 2>/dev/null) in *GNU*) ;; *) tar=gtar ;; esac
    $tar --format=ustar --no-recursion --owner=0 --group=0 --numeric-owner --mtime="$date 00:00:00Z" --mode=u=rwX,go=rX \
        --transform="s|^|$name/|" -cf "$tmp/tar" -T "$tmp/list"
    gzip -n -9 <"$tmp/tar" >"$archive"
}

# What is not part of smr, and who needs it.
others='C-library DEPENDENCY_OF NOASSERTION the platform: memcpy, memmove, memset, memcmp; threads and files for the program
numpy OPTIONAL_DEPENDENCY_OF BSD-3-Clause for the Python module alone
cmocka TEST_DEPENDENCY_OF Apache-2.0 for the tests alone'

# SPDX asks for SHA-1 of each file, and of all of these in order; SHA-256 is what to compare.
sbom() {
    tr '\n' '\0' <"$tmp/list" >"$tmp/list0"
    xargs -0 sha256sum <"$tmp/list0" >"$tmp/sha256"
    xargs -0 sha1sum <"$tmp/list0" >"$tmp/sha1"
    xargs -0 grep -l 'SPDX-License-Identifier: MIT' <"$tmp/list0" >"$tmp/tagged"
    code=$(cut -d ' ' -f 1 "$tmp/sha1" | sort | tr -d '\n' | sha1sum | cut -d ' ' -f 1)
    cat <<END
SPDXVersion: SPDX-2.3
DataLicense: CC0-1.0
SPDXID: SPDXRef-DOCUMENT
DocumentName: $name
DocumentNamespace: https://spdx.org/spdxdocs/$name-$code
Creator: Tool: smr-dist.sh
Created: ${date}T00:00:00Z

PackageName: smr
SPDXID: SPDXRef-smr
PackageVersion: ${name##*-}
PackageFileName: ${archive##*/}
PackageDownloadLocation: NOASSERTION
FilesAnalyzed: true
PackageVerificationCode: $code
PackageChecksum: SHA256: $(sha256sum <"$archive" | cut -d ' ' -f 1)
PackageLicenseConcluded: MIT
PackageLicenseInfoFromFiles: MIT
PackageLicenseDeclared: MIT
PackageCopyrightText: <text>$(grep -i '^copyright' LICENSE)</text>
Relationship: SPDXRef-DOCUMENT DESCRIBES SPDXRef-smr
END
    awk 'FILENAME ~ /tagged$/ { tagged[$0] = 1; next }
        FILENAME ~ /sha1$/ { sha1[substr($0, 43)] = $1; next }
        {
            file = substr($0, 67)
            print "\nFileName: ./" file "\nSPDXID: SPDXRef-File-" ++n "\nFileChecksum: SHA1: " sha1[file]
            print "FileChecksum: SHA256: " $1 "\nLicenseConcluded: MIT"
            print "LicenseInfoInFile: " (file in tagged ? "MIT" : "NONE") "\nFileCopyrightText: NOASSERTION"
        }' "$tmp/tagged" "$tmp/sha1" "$tmp/sha256"
    echo "$others" | while read -r id relation licence text; do
        printf '\nPackageName: %s\nSPDXID: SPDXRef-%s\nPackageDownloadLocation: NOASSERTION\nFilesAnalyzed: false\n' "$id" "$id"
        printf 'PackageLicenseConcluded: NOASSERTION\nPackageLicenseDeclared: %s\nPackageCopyrightText: NOASSERTION\n' "$licence"
        printf 'PackageComment: <text>%s</text>\nRelationship: SPDXRef-%s %s SPDXRef-smr\n' "$text" "$id" "$relation"
    done
}

$what
