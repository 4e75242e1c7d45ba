#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""write_section.py FILE NAME: puts standard input between the lines `<!-- NAME -->` and `<!-- /NAME -->` of FILE."""
import os
import pathlib
import sys


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    path, name = pathlib.Path(sys.argv[1]), sys.argv[2]
    first, last = f"<!-- {name} -->\n", f"<!-- /{name} -->"
    text = path.read_text()
    if text.count(first) != 1 or text.count(last) != 1 or text.index(first) > text.index(last):
        sys.exit(f"{path}: needs one line {first.strip()} and after it one line {last}")
    before, rest = text.split(first)
    after = rest.split(last, 1)[1]
    fresh = path.with_suffix(".new")
    fresh.write_text(before + first + sys.stdin.read().rstrip("\n") + "\n" + last + after)
    os.replace(fresh, path)


if __name__ == "__main__":
    main()
