#!/usr/bin/env python3
"""A primary host application of Sparkplug that keeps every message in its order, in a file.

Usage: tools/gateway/host.py PORT FILE

A record is two lengths (2 and 4 bytes), a topic and a payload; a topic that begins with ! says what happened to the line.
Needs paho-mqtt 1.6.
"""

import json
import struct
import sys
import time

import paho.mqtt.client as paho

STATE = "spBv1.0/STATE/host"


def state(online):
    return json.dumps({"online": online, "timestamp": int(time.time() * 1000)})


def records(path):
    """The topics and payloads of a file."""
    with open(path, "rb") as file:
        while head := file.read(6):
            topic, payload = struct.unpack("<HI", head)
            yield file.read(topic).decode(), file.read(payload)


def main():
    port, path = int(sys.argv[1]), sys.argv[2]
    file = open(path, "ab", buffering=1 << 16)

    def keep(topic, payload=b""):
        file.write(struct.pack("<HI", len(topic.encode()), len(payload)) + topic.encode() + payload)

    def connected(client, *_):
        client.subscribe("spBv1.0/#", 1)

    def broken(*_):
        keep("!broken")

    def told(_client, _data, message):
        if not message.topic.startswith("spBv1.0/STATE/"):
            keep(message.topic, message.payload)

    client = paho.Client("host", clean_session=True)
    client.on_connect, client.on_disconnect, client.on_message = connected, broken, told
    client.on_subscribe = lambda *_: client.publish(STATE, state(True), 1, True)
    client.reconnect_delay_set(1, 1)
    client.will_set(STATE, state(False), 1, True)
    client.connect("127.0.0.1", port, 10)
    client.loop_start()
    # Who started it closes its input at the end.
    sys.stdin.read()
    client.loop_stop()
    file.close()


if __name__ == "__main__":
    main()
