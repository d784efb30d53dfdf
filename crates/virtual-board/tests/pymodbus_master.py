"""A Modbus master from elsewhere: everything that the board tells, as JSON. Usage: pymodbus_master.py PORT WORDS"""

import json
import sys

from pymodbus.client import ModbusSerialClient
from pymodbus.pdu.file_message import FileRecord

WORDS = int(sys.argv[2])
EVENT_BYTES = 32

# The board's line has even parity; a pseudo terminal has none, and pyserial refuses to set one there.
client = ModbusSerialClient(sys.argv[1], baudrate=19200, parity="N", timeout=1)
assert client.connect(), "no port"


def sound(answer):
    assert not answer.isError(), answer
    return answer


def identity():
    objects, first = {}, 0
    while True:
        answer = sound(client.read_device_information(read_code=3, object_id=first))
        objects.update({str(number): text.decode() for number, text in answer.information.items()})
        if not answer.more_follows:
            return objects
        first = answer.next_object_id


def event(number):
    record = FileRecord(file_number=1, record_number=(number - 1) * EVENT_BYTES // 2, record_length=EVENT_BYTES)
    return sound(client.read_file_record([record])).records[0].record_data.hex()


told = {
    "input": sound(client.read_input_registers(0, count=WORDS)).registers,
    "holding": sound(client.read_holding_registers(0, count=2)).registers,
    "identity": identity(),
    "event": event(1),
    "beyond": client.read_input_registers(WORDS, count=1).exception_code,
    "locked": client.write_register(1, 1).exception_code,
}
sound(client.write_registers(0, [0x4D4D, 1]))
print(json.dumps(told))
