"""What a host application put together from the messages of Sparkplug that it got; by this file's own reading of the
specification's schema (sparkplug_b.proto)."""

import collections
import struct

import host

LAMPS = ["RUN", "r1", "r2", "r3", "r4", "SENSOR", "LINE", "LOAD", "FAULT"]
RESIDUALS = [f"Residuals/r{k}" for k in range(1, 5)]
MEASURED = ["Voltage", "Current", "SupplyFrequency", "Speed"]
INTEGER, LONG, FLOAT, DOUBLE, BOOLEAN, TEXT = range(10, 16)


def varint(data, at):
    value, shift = 0, 0
    while True:
        byte = data[at]
        value |= (byte & 0x7F) << shift
        at += 1
        if byte < 0x80:
            return value, at
        shift += 7


def fields(data):
    """Numbers and values of a message's fields."""
    at = 0
    while at < len(data):
        key, at = varint(data, at)
        kind = key & 7
        if kind == 0:
            value, at = varint(data, at)
        elif kind == 2:
            length, at = varint(data, at)
            value, at = data[at:at + length], at + length
        elif kind == 5:
            value, at = struct.unpack_from("<f", data, at)[0], at + 4
        else:
            value, at = struct.unpack_from("<d", data, at)[0], at + 8
        yield key >> 3, value


class Thing:
    """The node or a motor, as a host knows it."""

    def __init__(self):
        self.names, self.values = {}, {}


class Seen:
    """Everything that arrived. `seconds` and `events` are lists of (key, values), as the store's."""

    def __init__(self):
        self.seconds, self.events, self.gaps = [], [], []
        self.holes, self.unborn, self.messages, self.births, self.deaths, self.historical = 0, 0, 0, 0, 0, 0

    def second(self, motor, state):
        lamps = 0
        for k, lamp in enumerate(LAMPS):
            lamps |= state["Lamps/" + lamp] << 2 * k
        residuals = [None if (r := state[name]) is None else round(r * 1e4) for name in RESIDUALS]
        counts = [state[name] for name in ("Windows/Total", "Windows/Judged", "Windows/NotJudged", "LikelyFault")]
        values = (lamps, *counts, *residuals, *(state[name] for name in MEASURED))
        self.seconds.append(((motor, state["Second/Start"], state["Second/Number"]), values))

    def take_group(self, motor, state, names):
        if "Second/Number" in names:
            self.second(motor, state)
        if "Event/Number" in names:
            values = (state["Event/Cause"], state["Event/Times"], [state["Event/Value1"], state["Event/Value2"]])
            self.events.append(((motor, state["Event/Number"]), values))
        if "Gap/First" in names or "Gap/Last" in names:
            self.gaps.append((motor, state))


def metric(data, thing, is_birth):
    """Name, time, whether it is of the past, and value."""
    parts = dict(fields(data))
    if is_birth and 2 in parts:
        thing.names[parts[2]] = parts[1].decode()
    name = thing.names.get(parts.get(2)) or parts.get(1, b"").decode()
    value = next((parts[kind] for kind in range(INTEGER, TEXT + 1) if kind in parts), None)
    return name, parts.get(3), bool(parts.get(5)), None if parts.get(7) else value


def read(path):
    """Goes through all messages as a host does."""
    seen, things, expected = Seen(), collections.defaultdict(Thing), None
    for topic, payload in host.records(path):
        if topic == "!broken":
            expected = None
            continue
        parts = topic.split("/")
        kind, motor = parts[2], parts[4] if len(parts) > 4 else ""
        seen.messages += 1
        if kind == "NDEATH":
            seen.deaths += 1
            continue
        metrics, number = [], None
        is_birth = kind in ("NBIRTH", "DBIRTH")
        if is_birth:
            things[motor] = Thing()
        thing = things[motor]
        for field, value in fields(payload):
            if field == 3:
                number = value
            elif field == 2:
                metrics.append(metric(value, thing, is_birth))
        seen.births += kind == "NBIRTH"
        if kind != "NBIRTH" and expected is not None:
            seen.holes += number != expected
        expected = (number + 1) % 256
        past = collections.defaultdict(dict)
        for name, time, is_past, value in metrics:
            if not name:
                seen.unborn += 1
            elif is_past:
                past[time][name] = value
            else:
                thing.values[name] = value
        # A birth repeats what is known: no second is in it that does not come as data too.
        if kind != "DDATA":
            continue
        for state in past.values():
            seen.historical += "Second/Number" in state
            seen.take_group(motor, state, state)
        seen.take_group(motor, thing.values, {name for name, _, is_past, _ in metrics if not is_past})
    return seen
