"""Fails when a function that matches a pattern can be reached from another one by direct calls or jumps.

Usage: reachable.py ELF OBJDUMP START FORBIDDEN-PATTERN   (START is a part of a symbol's name)
"""

import bisect
import collections
import re
import subprocess
import sys

INSTRUCTION = re.compile(r"^\s*([0-9a-f]+):\s+(\S+)\s*(.*)$")
BRANCH = re.compile(r"^(bl?x?|b(eq|ne|cs|cc|hs|lo|mi|pl|vs|vc|hi|ls|ge|lt|gt|le)|cbn?z)(\.[nw])?$")
ADDRESS = re.compile(r"(?:0x)?([0-9a-f]{7,8})\b")


def functions(elf):
    """Start addresses and names of all functions, in the order of their addresses."""
    lines = subprocess.run(["nm", elf], capture_output=True, text=True, check=True).stdout.splitlines()
    found = {}
    for line in lines:
        address, kind, name = (line.split(maxsplit=2) + [""] * 3)[:3]
        if kind in ("T", "t", "W", "w") and not name.startswith("$"):
            found[int(address, 16) & ~1] = name
    return sorted(found), found


def calls(elf, objdump, starts, names):
    """For every function the functions that it branches to, and the set of those that branch through a register."""
    def owner(address):
        place = bisect.bisect_right(starts, address) - 1
        return names[starts[place]] if place >= 0 else None

    graph, indirect = collections.defaultdict(set), set()
    text = subprocess.run([objdump, "-d", "--no-show-raw-insn", elf], capture_output=True, text=True, check=True).stdout
    for line in text.splitlines():
        instruction = INSTRUCTION.match(line)
        if not instruction or not BRANCH.match(instruction.group(2)):
            continue
        here = owner(int(instruction.group(1), 16))
        # Of the operands the target is the last address; a comment behind "@" repeats its distance.
        targets = ADDRESS.findall(instruction.group(3).split("@")[0].split("<")[0])
        if targets:
            graph[here].add(owner(int(targets[-1], 16)))
        elif re.match(r"r\d+", instruction.group(3)):
            indirect.add(here)
    return graph, indirect


def main() -> int:
    elf, objdump, start, forbidden = sys.argv[1:5]
    starts, names = functions(elf)
    graph, indirect = calls(elf, objdump, starts, names)
    begin = [name for name in names.values() if start in name]
    if not begin or not any(graph[name] for name in begin):
        print(f"no function called {start} that calls anything: nothing was checked", file=sys.stderr)
        return 1
    came_from = {name: None for name in begin}
    queue = collections.deque(begin)
    while queue:
        name = queue.popleft()
        for callee in graph[name] - came_from.keys():
            came_from[callee] = name
            queue.append(callee)
    bad = [name for name in came_from if re.search(forbidden, name)]
    for name in bad:
        way = []
        while name:
            way.append(name)
            name = came_from[name]
        print("reachable: " + " <- ".join(way), file=sys.stderr)
    if not bad:
        print(f"{start} reaches {len(came_from)} functions by direct branches, none that panics")
    for name in sorted(indirect & came_from.keys()):
        print(f"branches through a register, not followed, in {name}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
