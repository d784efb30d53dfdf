"""A Modbus master from elsewhere configures a board, and finds it at its new address and speed. Prints what holds, as JSON.

Usage: pymodbus_configure.py PORT WORDS.json UNIT BAUD: the registers to be written, and where the board answers then
"""

import json
import sys
import time

from pymodbus.client import ModbusSerialClient

port, words, unit, baud = sys.argv[1], json.load(open(sys.argv[2])), int(sys.argv[3]), int(sys.argv[4])
KEY, COMMIT, CONFIRM = 0x4D4D, 4, 5
STAGED, ACTIVE = 1000, 2000


def connect(baudrate):
    # The board's line has even parity; a pseudo terminal has none, and pyserial refuses to set one there.
    client = ModbusSerialClient(port, baudrate=baudrate, parity="N", timeout=1)
    assert client.connect(), "no port"
    return client


def sound(answer):
    assert not answer.isError(), answer
    return answer


def block(client, first, device_id):
    registers = []
    while len(registers) < len(words):
        count = min(125, len(words) - len(registers))
        answer = client.read_holding_registers(first + len(registers), count=count, device_id=device_id)
        registers += sound(answer).registers
    return registers


client = connect(19200)
for first in range(0, len(words), 123):
    sound(client.write_registers(STAGED + first, words[first : first + 123]))
assert block(client, STAGED, 1) == words
sound(client.write_registers(0, [KEY, COMMIT]))
client.close()
time.sleep(0.3)
client = connect(baud)
assert block(client, ACTIVE, unit) == words
sound(client.write_registers(0, [KEY, CONFIRM], device_id=unit))
time.sleep(0.3)
print(json.dumps(block(client, ACTIVE, unit)))
