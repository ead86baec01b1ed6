#!/bin/bash
# C tests, and a short capture inside YADE, under valgrind: fails at an error or a leak that has a frame of ours.
#     tests/memcheck.sh [c] [yade]
# Needs a build of the presets c-only and default, and valgrind. Takes half an hour.
cd "$(dirname "$(readlink -f "$0")")/.." || exit 2
logs=build/memcheck
mkdir -p $logs
rm -f $logs/*.xml
python=${PYTHON:-/usr/bin/python3}
check() { # <name> <command ...>
    local name=$1
    shift
    valgrind -q --leak-check=full --show-leak-kinds=definite --xml=yes --xml-file="$logs/$name.xml" "$@" >"$logs/$name.log" 2>&1 || {
        echo "$name ended with $?: $logs/$name.log"
        return 1
    }
}

bad=0
what=${*:-c yade}
if [[ $what == *c* ]]; then
    for program in build/c-only/tests/c/test_*; do
        name=$(basename "$program")
        [ "$name" = test_sets ] && continue # instructions that valgrind does not know
        check "$name" "$program" || bad=1
    done
    check fuzz --trace-children=yes build/c-only/tests/c/fuzz 2000 1 || bad=1
fi
if [[ $what == *yade* ]]; then
    # Python's own allocator and Boost make noise that has no frame of ours.
    PYTHONMALLOC=malloc OMP_NUM_THREADS=1 PYTHONPATH=$PWD/build/python check capture "$python" tests/capture.py || bad=1
fi
"$python" - $logs/*.xml <<'END' || bad=1
"""Counts errors that have a frame in plugin/ and prints their places."""
import collections
import re
import sys
import xml.etree.ElementTree as tree

ours = collections.Counter()
for path in sys.argv[1:]:
    text = re.sub(r"[^\x09\x0a\x0d\x20-\x7e]", "?", open(path, errors="replace").read())
    if not text.rstrip().endswith("</valgrindoutput>"):
        text += "</valgrindoutput>"
    for error in tree.fromstring(text).iter("error"):
        for frame in error.iter("frame"):
            if "/plugin/" in (frame.findtext("dir") or ""):
                place = f"{frame.findtext('file')}:{frame.findtext('line')} {frame.findtext('fn')}"
                ours[f"{error.findtext('kind')} at {place}"] += 1
                break
print(f"{len(sys.argv) - 1} runs, {sum(ours.values())} errors with a frame of ours")
print("\n".join(ours))
sys.exit(bool(ours))
END
exit $bad
