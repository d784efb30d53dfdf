"""Reads a disassembly and fails when a function that matches a pattern can be reached by direct calls or jumps.

Usage: objdump -d ELF | reachable.py START FORBIDDEN-PATTERN
"""

import collections
import re
import sys

FUNCTION = re.compile(r"^[0-9a-f]+ <(.+)>:$")
TARGET = re.compile(r"\s(?:bl?x?|b[a-z]{2}|cbn?z|b\.w)(?:\.[nw])?\s.*<([^>+]+)(?:\+0x[0-9a-f]+)?>")
INDIRECT = re.compile(r"\sblx?\s+r\d+")


def main() -> int:
    start, forbidden = sys.argv[1], re.compile(sys.argv[2])
    calls, indirect, current = collections.defaultdict(set), set(), None
    for line in sys.stdin:
        if function := FUNCTION.match(line):
            current = function.group(1)
            calls[current]
        elif current and (target := TARGET.search(line)):
            calls[current].add(target.group(1))
        elif current and INDIRECT.search(line):
            indirect.add(current)
    starts = [name for name in calls if start in name]
    if not starts:
        print(f"no function is called {start}: nothing was checked", file=sys.stderr)
        return 1
    came_from = {name: None for name in starts}
    queue = collections.deque(starts)
    while queue:
        name = queue.popleft()
        for callee in calls[name] - came_from.keys():
            came_from[callee] = name
            queue.append(callee)
    bad = [name for name in came_from if forbidden.search(name)]
    for name in bad:
        way = []
        while name:
            way.append(name)
            name = came_from[name]
        print("reachable: " + " <- ".join(way), file=sys.stderr)
    through = sorted(indirect & came_from.keys())
    print(f"{start} reaches {len(came_from)} functions, none that panics" if not bad else "a panic is within reach")
    if through:
        print("calls through pointers, not followed, in: " + ", ".join(through))
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
