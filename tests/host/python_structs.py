"""python_structs.py: prints C source that compiles only where structs, calls and sentences of port/python/smr.py are the
header's, for test_host_python.sh.

SPDX-License-Identifier: MIT
"""
import ctypes
import os
import re
import sys

TOP = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.insert(0, os.path.join(TOP, "port", "python"))
import smr  # noqa: E402

HEADER = os.path.join(TOP, "include", "smr.h")


def c_kind(kind):
    """What _Generic() must find, or None."""
    return {ctypes.c_uint32: "uint32_t", ctypes.c_float: "float", ctypes.c_double: "double",
            ctypes.c_uint64: "uint64_t", ctypes.c_size_t: "size_t"}.get(kind)


def check_calls(header):
    """The prototypes in the header against the table of calls."""
    codes = {"uint32_t": "u", "size_t": "z", "uint64_t": "q", "float": "f", "smr_status": "u"}
    declared = {}
    for name, arguments in re.findall(r"^smr_status (smr_\w+)\(([^;]*)\);", header, re.M):
        words = [a.strip() for a in " ".join(arguments.split()).split(",")]
        declared[name] = "".join("p" if "*" in a else codes.get(a.split()[0], "p") for a in words)
    for name, expected in smr._CALLS.items():
        if not name.startswith("smr_pthread") and declared.get(name) != expected:
            print(f"#error {name} takes {declared.get(name)}, smr.py gives {expected}")
    print(f"/* {len(smr._CALLS)} calls */")


def main():
    with open(HEADER, encoding="utf-8") as file:
        header = file.read()
    for number, text in re.findall(r"SMR_E_\w+ = (-\d+),? +/\* (.*?) \*/", header):
        if smr._SENTENCES.get(int(number)) != text:
            print(f"#error smr.py does not say of {number}: {text}")
    check_calls(header)
    print("#include <smr.h>")
    table = dict(smr.STRUCTS, smr_config=smr._Config, smr_prepare_config=smr._PrepareConfig,
                 smr_saved_info=smr._SavedInfo)
    with open(os.path.join(TOP, "src", "base", "settings_config.def"), encoding="utf-8") as file:
        rows = re.findall(r"^SMR_SETTING\(\w+, \d+, ([a-z_.]+), (\w+),", file.read(), re.M)
    paths = {"smr_config": {name: path for path, name in rows}}  # where a setting is in C
    for name, kind in table.items():
        print(f'_Static_assert(sizeof({name}) == {ctypes.sizeof(kind)}, "size of {name}");')
        for field, of in kind._fields_:
            where, field = getattr(kind, field), paths.get(name, {}).get(field, field)
            print(f'_Static_assert(offsetof({name}, {field}) == {where.offset}, "{name}.{field}");')
            print(f'_Static_assert(sizeof((({name} *)0)->{field}) == {where.size}, "{name}.{field}");')
            if c_kind(of) is not None:
                print(f'_Static_assert(_Generic((({name} *)0)->{field}, {c_kind(of)}: 1, default: 0), "{field}");')
    print(f"int main(void) {{ return {len(table)} == 0; }}")


main()
