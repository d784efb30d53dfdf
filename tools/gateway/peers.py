#!/usr/bin/env python3
"""Who sends and who keeps, at a broker without a store of ours: numbers at a steady rate, and which of them were acknowledged.

Usage: tools/gateway/peers.py mqtt-send PORT RATE FILE | mqtt-keep PORT FILE | jetstream-send PORT RATE FILE | jetstream-read PORT FILE

A sender writes each number into FILE when the broker has acknowledged it; mqtt-keep writes each number that it gets before it
acknowledges it; jetstream-read writes what a stream holds. mqtt-send and mqtt-keep have sessions that the broker keeps, and QoS 1.
Needs paho-mqtt 1.6 and nats-py.
"""

import asyncio
import os
import signal
import sys
import time

SUBJECT = "plant.second"


def log(path):
    """Writes numbers so that a killed process has written them."""
    file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    return lambda number: os.write(file, b"%d\n" % number)


class Ended:
    """Becomes true when somebody asks this process to end."""

    def __init__(self):
        self.now = False
        signal.signal(signal.SIGTERM, lambda *_: setattr(self, "now", True))


def mqtt(name, port):
    import paho.mqtt.client as paho

    client = paho.Client(name, clean_session=False)
    client.reconnect_delay_set(1, 1)
    client.max_queued_messages_set(0)
    while True:
        try:
            client.connect("127.0.0.1", port, 10)
            return client
        except OSError:
            # It was just started.
            time.sleep(0.2)


def mqtt_send(port, rate, path):
    acknowledged, numbers, ended = log(path), {}, Ended()
    client = mqtt("sender", port)
    early = set()

    def answered(_client, _data, packet):
        # The answer may be there before `publish` has told the number of its packet.
        if packet in numbers:
            acknowledged(numbers.pop(packet))
        else:
            early.add(packet)

    client.on_publish = answered
    client.loop_start()
    begin, number = time.monotonic(), 0
    while not ended.now:
        due = int((time.monotonic() - begin) * rate)
        while number < due:
            number += 1
            packet = client.publish(SUBJECT, b"%d" % number, 1).mid
            numbers[packet] = number
            if packet in early:
                early.discard(packet)
                acknowledged(numbers.pop(packet))
        time.sleep(0.01)
    until = time.monotonic() + 20
    while numbers and time.monotonic() < until:
        time.sleep(0.1)


def mqtt_keep(port, path):
    keep, ended = log(path), Ended()
    client = mqtt("keeper", port)
    client.on_connect = lambda *_: client.subscribe(SUBJECT, 1)
    client.on_message = lambda _client, _data, message: keep(int(message.payload))
    client.loop_start()
    while not ended.now:
        time.sleep(0.1)


async def stream(port):
    import nats

    async def expected(_error):
        """Servers are killed here."""

    line = await nats.connect(f"nats://127.0.0.1:{port}", max_reconnect_attempts=-1, reconnect_time_wait=0.5, error_cb=expected)
    return line, line.jetstream()


async def jetstream_send(port, rate, path):
    import nats.errors

    acknowledged, ended = log(path), Ended()
    line, js = await stream(port)
    await js.add_stream(name="plant", subjects=[SUBJECT])
    begin, number = time.monotonic(), 0
    while not ended.now:
        due = int((time.monotonic() - begin) * rate)
        while number < due and not ended.now:
            number += 1
            try:
                await js.publish(SUBJECT, b"%d" % number, timeout=1)
                acknowledged(number)
            except (nats.errors.Error, asyncio.TimeoutError):
                # Without an answer nothing was promised; a real sender would send it again.
                await asyncio.sleep(0.2)
        await asyncio.sleep(0.01)
    await line.close()


async def jetstream_read(port, path):
    import nats.errors

    keep = log(path)
    line, js = await stream(port)
    reader = await js.pull_subscribe(SUBJECT, durable="reader")
    while True:
        try:
            messages = await reader.fetch(1000, timeout=3)
        except (nats.errors.TimeoutError, asyncio.TimeoutError):
            break
        for message in messages:
            keep(int(message.data))
            await message.ack()
    await line.close()


def main():
    match sys.argv[1:]:
        case ["mqtt-send", port, rate, path]:
            mqtt_send(int(port), float(rate), path)
        case ["mqtt-keep", port, path]:
            mqtt_keep(int(port), path)
        case ["jetstream-send", port, rate, path]:
            asyncio.run(jetstream_send(int(port), float(rate), path))
        case ["jetstream-read", port, path]:
            asyncio.run(jetstream_read(int(port), path))
        case _:
            sys.exit(__doc__)


if __name__ == "__main__":
    main()
