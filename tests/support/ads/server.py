"""A controller for the tests of the ADS link, on the test server of pyads.

Symbols, orders and faults come as JSON lines on stdin; what a client writes is told as JSON lines on stdout. pyads
has the frames, the headers and the descriptions of symbols; added here are sum requests with an error for each part,
error codes, parts of arrays, frames of any length, and faults.
"""

import json
import os
import select
import socket
import struct
import sys
import threading
import time

# Whatever a library prints must not come between the lines.
told = sys.stdout
sys.stdout = sys.stderr

from pyads import constants  # noqa: E402
from pyads.testserver import AdsTestServer  # noqa: E402
from pyads.testserver.advanced_handler import AdvancedHandler, PLCVariable  # noqa: E402
from pyads.testserver.handler import AmsResponseData  # noqa: E402
from pyads.testserver.testserver import AdsClientConnection  # noqa: E402

GROUP = 0x4040
SYMBOL_VERSION = 0xF008
SUM_READ_EX = 0xF083
UNKNOWN_REQUEST = 0x701
WRONG_OFFSET = 0x703
WRONG_SIZE = 0x705
NO_SYMBOL = 0x710

TYPES = {
    "BOOL": ("?", constants.ADST_BIT),
    "SINT": ("b", constants.ADST_INT8),
    "INT": ("h", constants.ADST_INT16),
    "DINT": ("i", constants.ADST_INT32),
    "UDINT": ("I", constants.ADST_UINT32),
    "ULINT": ("Q", constants.ADST_UINT64),
    "REAL": ("f", constants.ADST_REAL32),
    "LREAL": ("d", constants.ADST_REAL64),
}
TEXT_BYTES = 81
LATE_S = 3.0

lock = threading.RLock()
printing = threading.Lock()


def tell(message):
    with printing:
        told.write(json.dumps(message) + "\n")
        told.flush()


class Refused(Exception):
    def __init__(self, code):
        super().__init__(hex(code))
        self.code = code


class Variable(PLCVariable):
    """A symbol with the numbers in it."""

    def __init__(self, name, kind, count, offset):
        self.kind = kind
        if kind == "STRING":
            base, size, type_name = constants.ADST_STRING, TEXT_BYTES, f"STRING({TEXT_BYTES - 1})"
        else:
            code, base = TYPES[kind]
            size = struct.calcsize("<" + code) * count
            type_name = kind if count == 1 else f"ARRAY [1..{count}] OF {kind}"
        super().__init__(name, bytes(size), base, type_name, GROUP, offset)

    def set(self, values):
        if self.kind == "STRING":
            text = values[0].encode("cp1252", "replace")[: TEXT_BYTES - 1]
            self.value = text.ljust(TEXT_BYTES, b"\0")
        else:
            code = TYPES[self.kind][0]
            whole = code not in "fd"
            numbers = [int(v) if whole else float("nan") if v is None else v for v in values]
            self.value = struct.pack(f"<{len(numbers)}{code}", *numbers)

    def numbers(self):
        code = TYPES[self.kind][0]
        return list(struct.unpack(f"<{self.size // struct.calcsize('<' + code)}{code}", self.value))


class Part:
    """Some bytes of a symbol, as the handler of pyads reads and writes them."""

    def __init__(self, variable, start):
        self.variable = variable
        self.start = start

    @property
    def value(self):
        return self.variable.value[self.start :]

    def register_notification(self):
        return self.variable.register_notification()

    def write(self, value, request=None):
        old = self.variable.value
        if self.start + len(value) > len(old):
            raise Refused(WRONG_SIZE)
        self.variable.value = old[: self.start] + value + old[self.start + len(value) :]
        tell({"wrote": self.variable.name, "values": self.variable.numbers()})


class Handler(AdvancedHandler):
    """The symbols, and what is wrong with them."""

    def __init__(self):
        super().__init__()
        self.offset = 0x100
        self.version = 1
        self.state = 5
        self.codes = {}
        self.sums = True
        self.counts = {}

    def declare(self, name, kind, count, values):
        known = [key for key, variable in self._data.items() if variable.name == name]
        for key in known:
            del self._data[key]
        variable = Variable(name, kind, count, self.offset)
        self.offset += variable.size + 8
        variable.set(values)
        self.add_variable(variable)

    def move(self):
        """After a restart nothing is where it was."""
        variables = list(self._data.values())
        self._data = {}
        self.offset += 0x1000
        for variable in variables:
            variable.index_offset = self.offset
            self.offset += variable.size + 8
            self.add_variable(variable)
        self.version += 1

    def get_variable(self, name):
        return next(v for v in self._data.values() if v.name == name)

    def check(self, name):
        if name in self.codes:
            raise Refused(self.codes[name])

    def get_variable_by_indices(self, group, offset):
        if group == SYMBOL_VERSION:
            version = Variable("", "SINT", 1, 0)
            version.set([self.version % 100])
            return version
        for variable in self._data.values():
            start = offset - variable.index_offset
            if group == GROUP and 0 <= start < variable.size:
                self.check(variable.name)
                return Part(variable, start)
        raise Refused(WRONG_OFFSET)

    def get_variable_by_name(self, name):
        name = name.strip("\0")
        self.check(name)
        for variable in self._data.values():
            if variable.name == name:
                return variable
        raise Refused(NO_SYMBOL)

    def read_part(self, group, offset, size):
        value = self.get_variable_by_indices(group, offset).value[:size]
        if len(value) != size:
            raise Refused(WRONG_SIZE)
        return value

    def sum_read(self, count, data):
        heads, values = b"", b""
        for k in range(count):
            group, offset, size = struct.unpack_from("<III", data, 12 * k)
            try:
                value = self.read_part(group, offset, size)
                heads += struct.pack("<II", 0, size)
            except Refused as refused:
                value = bytes(size)
                heads += struct.pack("<II", refused.code, 0)
            values += value
        return heads + values

    def sum_write(self, count, data):
        at, results = 12 * count, b""
        for k in range(count):
            group, offset, size = struct.unpack_from("<III", data, 12 * k)
            try:
                self.get_variable_by_indices(group, offset).write(data[at : at + size])
                results += struct.pack("<I", 0)
            except Refused as refused:
                results += struct.pack("<I", refused.code)
            at += size
        return results

    def sum(self, group, count, data):
        if not self.sums:
            raise Refused(UNKNOWN_REQUEST)
        handle = self.sum_read if group == SUM_READ_EX else self.sum_write
        answer = handle(count, data)
        return struct.pack("<II", 0, len(answer)) + answer

    def handle_request(self, request):
        header = request.ams_header
        state = struct.pack("<H", struct.unpack("<H", header.state_flags)[0] | 1)
        command = struct.unpack("<H", header.command_id)[0]
        no_error = bytes(4)
        with lock:
            try:
                if command == constants.ADSCOMMAND_READSTATE:
                    answer = struct.pack("<IHH", 0, self.state, 0)
                    return AmsResponseData(state, no_error, answer)
                if command == constants.ADSCOMMAND_READWRITE:
                    group, offset, _, size = struct.unpack_from("<IIII", header.data)
                    if group in (SUM_READ_EX, constants.ADSIGRP_SUMUP_WRITE):
                        answer = self.sum(group, offset, header.data[16 : 16 + size])
                        return AmsResponseData(state, no_error, answer)
                return super().handle_request(request)
            except Refused as refused:
                return AmsResponseData(state, no_error, struct.pack("<II", refused.code, 0))


def kind_of(request):
    command = struct.unpack("<H", request.ams_header.command_id)[0]
    group = struct.unpack("<I", request.ams_header.data[:4].ljust(4, b"\0"))[0]
    if command == constants.ADSCOMMAND_READSTATE:
        return "state"
    if command in (constants.ADSCOMMAND_ADDDEVICENOTE, constants.ADSCOMMAND_DELDEVICENOTE):
        return "lookup"
    if command == constants.ADSCOMMAND_WRITE or group == constants.ADSIGRP_SUMUP_WRITE:
        return "write"
    if group == constants.ADSIGRP_SYM_INFOBYNAMEEX:
        return "lookup"
    return "read"


class Faults:
    """What happens to which request: the connection ends before it is treated, after that, or amid the answer."""

    def __init__(self):
        self.orders = []
        self.delay_s = 0.0

    def action(self, kind):
        for order in self.orders:
            if order["kind"] != kind:
                continue
            order["number"] -= 1
            if order["number"] == 0:
                self.orders.remove(order)
                return order["action"]
        return None


faults = Faults()


class Connection(AdsClientConnection):
    """Takes frames apart by their length; treats them one after the other."""

    def receive(self, count):
        data = b""
        while len(data) < count and self._run:
            ready, _, _ = select.select([self.client], [], [], 0.1)
            if not ready:
                continue
            more = self.client.recv(count - len(data))
            if not more:
                return None
            data += more
        return data if self._run else None

    def run(self):
        try:
            while self._run:
                head = self.receive(6)
                rest = head and self.receive(struct.unpack("<I", head[2:])[0])
                if not rest or not self.treat(self.construct_request(head + rest)):
                    break
        except OSError:
            pass
        self.client.close()

    def treat(self, request):
        kind = kind_of(request)
        with lock:
            action = faults.action(kind)
            delay_s = faults.delay_s
            self.handler.counts[kind] = self.handler.counts.get(kind, 0) + 1
        if action == "before":
            return False
        if action == "late":
            time.sleep(LATE_S)
        response = self.handler.handle_request(request)
        answer = self.construct_response(response, request)
        if action == "after":
            return False
        if action == "half":
            self.client.sendall(answer[: len(answer) // 2])
            return False
        if action == "stray":
            # The answer to another request: its number is not that of ours.
            answer = answer[:34] + b"\xff" * 4 + answer[38:]
        if delay_s:
            time.sleep(delay_s)
        self.client.sendall(answer)
        return True


class Server(AdsTestServer):
    """Accepts clients."""

    def __init__(self, handler, port=0):
        super().__init__(handler, "127.0.0.1", port, logging=False)
        self.port = self.server.getsockname()[1]
        self.server.listen(5)

    def run(self):
        while self._run:
            try:
                ready, _, _ = select.select([self.server], [], [], 0.05)
                if not ready:
                    continue
                client, address = self.server.accept()
            except (OSError, ValueError):
                break
            client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            connection = Connection(self.handler, client, address, self, daemon=True)
            self.clients.append(connection)
            connection.start()


class Rig:
    """The server and its orders."""

    def __init__(self):
        self.handler = Handler()
        self.server = Server(self.handler)
        self.server.start()

    def restart(self, pause_s):
        port = self.server.port
        self.server.close()
        self.server.join()
        time.sleep(pause_s)
        with lock:
            self.handler.move()
        self.server = Server(self.handler, port)
        self.server.start()

    def order(self, order):
        if "restart" in order:
            self.restart(order["restart"])
        with lock:
            handler = self.handler
            for name, kind, count, values in order.get("declare", []):
                handler.declare(name, kind, count, values)
            for name, values in order.get("set", {}).items():
                handler.get_variable(name).set(values)
            if "fault" in order:
                faults.orders.append(order["fault"])
            faults.delay_s = order.get("delay_s", faults.delay_s)
            handler.codes = order.get("codes", handler.codes)
            handler.sums = order.get("sums", handler.sums)
            handler.state = order.get("state", handler.state)
            if order.get("move"):
                handler.move()
            for name in order.get("remove", []):
                del handler._data[(GROUP, handler.get_variable(name).index_offset)]
            if "id" in order:
                tell({"done": order["id"], "counts": handler.counts})


def main():
    rig = Rig()
    tell({"port": rig.server.port})
    for line in sys.stdin:
        rig.order(json.loads(line))
    os._exit(0)


main()
