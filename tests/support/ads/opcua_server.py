"""A controller for the tests of the OPC UA link, on the server of asyncua.

Orders and what clients write are the same lines of JSON as those of server.py. asyncua has the messages, sessions and
nodes; added here are counts of requests, status codes for single nodes, and connections that end amid a request.

An argument of JSON makes it a server with security: the policies by their names in asyncua, the user with the password, the
files of certificates of users, the policy of the tokens of users, the lifetime of keys, and what is wrong with its certificate,
which the package cryptography makes.
"""

import asyncio
import datetime
import hashlib
import ipaddress
import json
import logging
import math
import os
import sys
import threading

# Whatever a library prints must not come between the lines.
told = sys.stdout
sys.stdout = sys.stderr
logging.disable(logging.CRITICAL)

from asyncua import Server, ua  # noqa: E402
from asyncua.common.connection import SecureConnection  # noqa: E402
from asyncua.crypto.permission_rules import User, UserRole  # noqa: E402
from asyncua.crypto.validator import CertificateValidator, CertificateValidatorOptions  # noqa: E402
from asyncua.server.uaprocessor import UaProcessor  # noqa: E402
from asyncua.server.user_managers import CertificateUserManager  # noqa: E402
from asyncua.ua.ua_binary import nodeid_from_binary, struct_from_binary  # noqa: E402
from cryptography import x509  # noqa: E402
from cryptography.hazmat.primitives import hashes, serialization  # noqa: E402
from cryptography.hazmat.primitives.asymmetric import rsa  # noqa: E402

NAMESPACE = 4
LATE_S = 3.0
STATE = ua.NodeId(ua.ObjectIds.Server_ServerStatus_State)
READ = ua.ObjectIds.ReadRequest_Encoding_DefaultBinary
WRITE = ua.ObjectIds.WriteRequest_Encoding_DefaultBinary

TYPES = {
    "BOOL": ua.VariantType.Boolean,
    "SINT": ua.VariantType.SByte,
    "INT": ua.VariantType.Int16,
    "DINT": ua.VariantType.Int32,
    "UDINT": ua.VariantType.UInt32,
    "ULINT": ua.VariantType.UInt64,
    "REAL": ua.VariantType.Float,
    "LREAL": ua.VariantType.Double,
    "STRING": ua.VariantType.String,
}


def tell(message):
    told.write(json.dumps(message) + "\n")
    told.flush()


class Orders:
    """What was ordered, and how many requests of each kind there were."""

    faults = []
    counts = {}
    codes = {}
    delay_s = 0.0

    @classmethod
    def action(cls, kind):
        cls.counts[kind] = cls.counts.get(kind, 0) + 1
        for fault in cls.faults:
            if fault["kind"] == kind:
                fault["number"] -= 1
                if fault["number"] == 0:
                    cls.faults.remove(fault)
                    return fault["action"]
        return None


class Kept:
    """Takes the bytes of an answer that is not sent."""

    def __init__(self):
        self.data = b""

    def write(self, data):
        self.data += data


def parts(kind, parameters):
    return parameters.NodesToRead if kind == READ else parameters.NodesToWrite


async def process_message(self, seqhdr, body):
    """The processor's own, with faults around it."""
    copy = body.copy()
    kind = nodeid_from_binary(copy).Identifier
    if kind not in (READ, WRITE):
        return await plain(self, seqhdr, body)
    struct_from_binary(ua.RequestHeader, copy)
    parameters = struct_from_binary(ua.ReadParameters if kind == READ else ua.WriteParameters, copy)
    nodes = [part.NodeId for part in parts(kind, parameters)]
    word = "state" if nodes == [STATE] else "read" if kind == READ else "write"
    action = Orders.action(word)
    if action == "before":
        self._transport.close()
        return False
    if action == "late":
        await asyncio.sleep(LATE_S)
    if Orders.delay_s:
        await asyncio.sleep(Orders.delay_s)
    real = self._transport
    if action in ("after", "half"):
        self._transport = Kept()
    result = await plain(self, seqhdr, body)
    if kind == WRITE:
        for part in parameters.NodesToWrite:
            if part.NodeId.Identifier not in Orders.codes:
                tell({"wrote": part.NodeId.Identifier, "values": listed(part.Value.Value.Value)})
    if action in ("after", "half"):
        data, self._transport = self._transport.data, real
        if action == "half":
            real.write(data[: len(data) // 2])
        real.close()
        return False
    return result


plain = UaProcessor.process_message
UaProcessor.process_message = process_message


open_channel = SecureConnection.open


def open_for(lifetime_ms):
    """Channels are opened for a time of the server's choice."""

    def opened(self, params, server):
        params.RequestedLifetime = lifetime_ms
        return open_channel(self, params, server)

    SecureConnection.open = opened


def listed(value):
    values = value if isinstance(value, list) else [value]
    return [None if isinstance(v, float) and not math.isfinite(v) else v for v in values]


def certificate(wishes):
    """A key and a certificate of our own; wishes say what is wrong with it."""
    key = rsa.generate_private_key(public_exponent=65537, key_size=wishes.get("bits", 2048))
    name = x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, "tests")])
    begins = datetime.datetime(2020, 1, 1, tzinfo=datetime.timezone.utc)
    year = wishes.get("until", 2100)
    host = ipaddress.ip_address(wishes.get("host", "127.0.0.1"))
    names = [x509.UniformResourceIdentifier(wishes.get("application", "urn:tests")), x509.DNSName("plc"), x509.IPAddress(host)]
    signs = wishes.get("signs", True)
    usage = x509.KeyUsage(signs, signs, True, True, False, False, False, False, False)
    purpose = x509.ObjectIdentifier("1.3.6.1.5.5.7.3." + wishes.get("purpose", "1"))
    made = (
        x509.CertificateBuilder(name, name, key.public_key(), x509.random_serial_number())
        .not_valid_before(begins)
        .not_valid_after(begins.replace(year=year))
        .add_extension(x509.SubjectAlternativeName(names), critical=False)
        .add_extension(usage, critical=True)
        .add_extension(x509.ExtendedKeyUsage([purpose]), critical=False)
        .sign(key, hashes.SHA256())
    )
    return key, made


class OneUser:
    """Knows one user."""

    def __init__(self, name, password):
        self.known = (name, password)

    def get_user(self, iserver, username=None, password=None, certificate=None):
        return User(role=UserRole.User, name=username) if (username, password) == self.known else None


class Rig:
    """The server and its orders."""

    def __init__(self, security):
        self.security = security
        user = security.get("user")
        self.certified = CertificateUserManager() if "certified" in security else None
        self.server = Server(user_manager=self.certified or (OneUser(*user) if user else None))
        self.kinds = {}
        self.fingerprint = None

    async def secure(self):
        key, made = certificate(self.security.get("certificate", {}))
        self.server.iserver.certificate, self.server.iserver.private_key = made, key
        der = made.public_bytes(serialization.Encoding.DER)
        self.fingerprint = hashlib.sha256(der).hexdigest()
        await self.server.set_application_uri("urn:tests")
        options = CertificateValidatorOptions.EXT_VALIDATION | CertificateValidatorOptions.PEER_CLIENT
        self.server.set_certificate_validator(CertificateValidator(options).validate)
        if "lifetime_ms" in self.security:
            open_for(self.security["lifetime_ms"])
        for k, path in enumerate(self.security.get("certified", [])):
            await self.certified.add_user(path, f"user {k}")
        if self.certified:
            self.server.set_identity_tokens([ua.X509IdentityToken])
        elif "user" in self.security:
            self.server.set_identity_tokens([ua.UserNameIdentityToken])

    async def start(self):
        await self.server.init()
        self.server.set_endpoint("opc.tcp://127.0.0.1:0")
        names = self.security.get("policies", ["NoSecurity"])
        self.server.set_security_policy([ua.SecurityPolicyType[name] for name in names])
        if self.security:
            await self.secure()
        for k in range(2, NAMESPACE + 1):
            await self.server.register_namespace(f"urn:tests:{k}")
        self.space = self.server.iserver.aspace
        service = self.server.iserver.attribute_service
        self.plain_read, self.plain_write = service.read, service.write
        service.read, service.write = self.read, self.write
        await self.server.start()
        if "token_policy" in self.security:
            for endpoint in self.server.iserver.endpoints:
                for token in endpoint.UserIdentityTokens:
                    token.SecurityPolicyUri = self.security["token_policy"]
        return self.server.bserver.port

    def read(self, parameters):
        answers = self.plain_read(parameters)
        for k, part in enumerate(parameters.NodesToRead):
            code = Orders.codes.get(part.NodeId.Identifier)
            if code is not None:
                answers[k] = ua.DataValue(StatusCode=ua.StatusCode(code))
        return answers

    async def write(self, parameters, user=None):
        good = [p for p in parameters.NodesToWrite if p.NodeId.Identifier not in Orders.codes]
        results = iter(await self.plain_write(ua.WriteParameters(NodesToWrite=good)))
        return [
            ua.StatusCode(Orders.codes[p.NodeId.Identifier])
            if p.NodeId.Identifier in Orders.codes
            else next(results)
            for p in parameters.NodesToWrite
        ]

    def variant(self, name, values):
        kind, count = self.kinds[name]
        whole = kind not in ("REAL", "LREAL", "STRING", "BOOL")
        values = [math.nan if v is None else int(v) if whole else v for v in values]
        if kind in ("REAL", "LREAL"):
            values = [float(v) for v in values]
        if kind == "BOOL":
            values = [bool(v) for v in values]
        return ua.Variant(values if count > 1 else values[0], TYPES[kind])

    async def declare(self, name, kind, count, values):
        node_id = ua.NodeId(name, NAMESPACE)
        if name in self.kinds:
            await self.remove(name)
        self.kinds[name] = (kind, count)
        variable = await self.server.nodes.objects.add_variable(node_id, name, self.variant(name, values))
        await variable.set_writable()

    async def remove(self, name):
        del self.kinds[name]
        await self.server.delete_nodes([self.server.get_node(ua.NodeId(name, NAMESPACE))])

    async def set(self, name, values, time):
        """Of one instant, and told to subscribers."""
        value = ua.DataValue(self.variant(name, values), SourceTimestamp=time)
        code = await self.space.write_attribute_value(ua.NodeId(name, NAMESPACE), ua.AttributeIds.Value, value)
        code.check()

    async def run_clock(self, name, cycle_s):
        """The time since now in a variable, in every cycle."""
        loop = asyncio.get_running_loop()
        begun = loop.time()
        while True:
            now = loop.time() - begun
            await self.set(name, [now], datetime.datetime.now(datetime.timezone.utc))
            await asyncio.sleep(cycle_s - now % cycle_s)

    async def restart(self, pause_s):
        port = self.server.bserver.port
        await self.server.bserver.stop()
        await asyncio.sleep(pause_s)
        self.server.bserver.port = port
        await self.server.bserver.start()

    async def order(self, order):
        if "restart" in order:
            await self.restart(order["restart"])
        for declaration in order.get("declare", []):
            await self.declare(*declaration)
        now = datetime.datetime.now(datetime.timezone.utc)
        for name, values in order.get("set", {}).items():
            await self.set(name, values, now)
        if "clock" in order:
            self.clock = asyncio.create_task(self.run_clock(*order["clock"]))
        if "fault" in order:
            Orders.faults.append(order["fault"])
        Orders.delay_s = order.get("delay_s", Orders.delay_s)
        Orders.codes = order.get("codes", Orders.codes)
        if "state" in order:
            value = ua.DataValue(ua.Variant(order["state"], ua.VariantType.Int32))
            self.space._nodes[STATE].attributes[ua.AttributeIds.Value].value = value
            self.space._nodes[STATE].attributes[ua.AttributeIds.Value].value_callback = None
        for name in order.get("null", []):
            node = self.space._nodes[ua.NodeId(name, NAMESPACE)]
            node.attributes[ua.AttributeIds.Value].value = ua.DataValue(ua.Variant(None))
        for name in order.get("remove", []):
            await self.remove(name)
        if "id" in order:
            tell({"done": order["id"], "counts": Orders.counts})


async def main():
    rig = Rig(json.loads(sys.argv[1]) if len(sys.argv) > 1 else {})
    port = await rig.start()
    tell({"port": port, "fingerprint": rig.fingerprint})
    loop = asyncio.get_running_loop()

    def listen():
        for line in sys.stdin:
            asyncio.run_coroutine_threadsafe(rig.order(json.loads(line)), loop).result()
        os._exit(0)

    threading.Thread(target=listen, daemon=True).start()
    await asyncio.Event().wait()


asyncio.run(main())
