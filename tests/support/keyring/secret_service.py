"""A session bus of D-Bus with nothing but a keyring (Secret Service), for the tests of stored passwords.

    secret_service.py FOLDER [silent]

It listens at FOLDER/bus, keeps its items in FOLDER/items.json, where the test can read and write them, and prints a line once it
listens. A silent one takes what it is asked and never answers, as a keyring that waits for its user to unlock it.
Messages are those of the package jeepney, the cryptography is that of the package cryptography.
"""

import asyncio
import json
import os
import sys
from pathlib import Path

from cryptography.hazmat.primitives import hashes, padding
from cryptography.hazmat.primitives.ciphers import Cipher, algorithms, modes
from cryptography.hazmat.primitives.kdf.hkdf import HKDF
from jeepney import HeaderFields, MessageType, new_error, new_method_return
from jeepney.low_level import Parser

# The second group of RFC 2409, with the generator 2.
PRIME = int(
    "FFFFFFFFFFFFFFFFC90FDAA22168C234C4C6628B80DC1CD129024E088A67CC74020BBEA63B139B22514A08798E3404DD"
    "EF9519B3CD3A431B302B0A6DF25F14374FE1356D6D51C245E485B576625E7EC6F44C42E9A637ED6B0BFF5CB6F406B7ED"
    "EE386BFB5A899FA5AE9F24117C4B1FE649286651ECE65381FFFFFFFFFFFFFFFF",
    16,
)
BUS = "org.freedesktop.DBus"
ROOT = "/org/freedesktop/secrets"
COLLECTION = ROOT + "/collection/login"
SESSION = ROOT + "/session/1"
CLIENT, SERVICE = ":1.1", ":1.2"
NOTHING = "/"


class Items:
    """The items with their attributes and secrets, in a file."""

    def __init__(self, path):
        self.path = path
        if not path.exists():
            self.save([])

    def all(self):
        return json.loads(self.path.read_text(encoding="utf-8"))

    def save(self, items):
        # In one step, because the test reads it at any time.
        part = self.path.with_suffix(".part")
        part.write_text(json.dumps(items), encoding="utf-8")
        part.replace(self.path)

    def found(self, attributes):
        items = enumerate(self.all())
        return [k for k, item in items if item and attributes.items() <= item["attributes"].items()]


class Session:
    """Encrypts secrets on their way."""

    def __init__(self, public_key):
        private = int.from_bytes(os.urandom(128), "big")
        size = 128
        self.public = pow(2, private, PRIME).to_bytes(size, "big").lstrip(b"\0")
        common = pow(int.from_bytes(public_key, "big"), private, PRIME).to_bytes(size, "big")
        self.key = HKDF(hashes.SHA256(), 16, None, b"").derive(common)

    def seal(self, secret):
        pad = padding.PKCS7(128).padder()
        iv = os.urandom(16)
        cipher = Cipher(algorithms.AES(self.key), modes.CBC(iv)).encryptor()
        return iv, cipher.update(pad.update(secret) + pad.finalize()) + cipher.finalize()

    def open(self, iv, sealed):
        pad = padding.PKCS7(128).unpadder()
        cipher = Cipher(algorithms.AES(self.key), modes.CBC(bytes(iv))).decryptor()
        plain = cipher.update(bytes(sealed)) + cipher.finalize()
        return pad.update(plain) + pad.finalize()


def path_of(number):
    return f"{COLLECTION}/{number}"


def number_of(path):
    return int(path.rsplit("/", 1)[1])


class Service:
    """Answers to method calls: a signature and values."""

    def __init__(self, items):
        self.items = items
        self.session = None

    def answer(self, path, member, body):
        return getattr(self, member)(path, *body)

    def Hello(self, _):
        return "s", (CLIENT,)

    def AddMatch(self, _, rule):
        return None, ()

    RemoveMatch = AddMatch

    def GetNameOwner(self, _, name):
        return "s", (BUS if name == BUS else SERVICE,)

    def StartServiceByName(self, _, name, flags):
        return "u", (2,)

    def Get(self, _, interface, name):
        known = {"Locked": ("b", False), "Label": ("s", "login"), "Collections": ("ao", [COLLECTION])}
        return "v", (known[name],)

    def GetAll(self, _, interface):
        return "a{sv}", ({"Collections": ("ao", [COLLECTION])},)

    def OpenSession(self, _, algorithm, public_key):
        if algorithm != "dh-ietf1024-sha256-aes128-cbc-pkcs7":
            raise ValueError("secrets on their way have to be encrypted")
        self.session = Session(bytes(public_key[1]))
        return "vo", (("ay", self.session.public), SESSION)

    def SearchItems(self, _, attributes):
        return "aoao", ([path_of(k) for k in self.items.found(attributes)], [])

    def ReadAlias(self, _, name):
        return "o", (COLLECTION if name == "default" else NOTHING,)

    def Unlock(self, _, paths):
        return "aoo", (paths, NOTHING)

    def CreateItem(self, _, properties, secret, replaces):
        attributes = properties["org.freedesktop.Secret.Item.Attributes"][1]
        items = self.items.all()
        items.append({"attributes": attributes, "secret": self.plain(secret)})
        self.items.save(items)
        return "oo", (path_of(len(items) - 1), NOTHING)

    def GetSecret(self, path, session):
        secret = self.items.all()[number_of(path)]["secret"].encode()
        return "(oayays)", ((SESSION, *self.session.seal(secret), "text/plain"),)

    def SetSecret(self, path, secret):
        items = self.items.all()
        items[number_of(path)]["secret"] = self.plain(secret)
        self.items.save(items)
        return None, ()

    def Delete(self, path):
        items = self.items.all()
        # Numbers of the others stay.
        items[number_of(path)] = None
        self.items.save(items)
        return "o", (NOTHING,)

    def plain(self, secret):
        _, iv, sealed, _ = secret
        return self.session.open(iv, sealed).decode()


async def greet(reader, writer):
    """Authentication, which everybody passes."""
    await reader.readexactly(1)
    while True:
        word = (await reader.readline()).split()
        if word[:1] == [b"BEGIN"]:
            return
        answers = {b"AUTH": b"OK 0123456789abcdef0123456789abcdef", b"NEGOTIATE_UNIX_FD": b"ERROR"}
        writer.write(answers.get(word[0], b"ERROR") + b"\r\n")


async def serve(reader, writer, service):
    await greet(reader, writer)
    parser, serial = Parser(), 0
    while data := await reader.read(65536):
        parser.add_data(data)
        while (message := parser.get_next_message()) is not None:
            fields = message.header.fields
            if message.header.message_type != MessageType.method_call:
                continue
            member, to = fields[HeaderFields.member], fields.get(HeaderFields.destination)
            if service is None and to != BUS:
                continue
            try:
                signature, body = (service or Service(None)).answer(fields[HeaderFields.path], member, message.body)
                answer = new_method_return(message, signature, body)
            except Exception as error:
                answer = new_error(message, BUS + ".Error.Failed", "s", (f"{member}: {error!r}",))
            serial += 1
            answer.header.fields[HeaderFields.sender] = BUS if to == BUS else SERVICE
            answer.header.fields[HeaderFields.destination] = CLIENT
            writer.write(answer.serialise(serial))


async def main(folder, *modes_of_it):
    items = Items(folder / "items.json")

    async def connected(reader, writer):
        service = None if "silent" in modes_of_it else Service(items)
        try:
            await serve(reader, writer, service)
        except (asyncio.IncompleteReadError, ConnectionError):
            pass
        writer.close()

    server = await asyncio.start_unix_server(connected, path=folder / "bus")
    print("listens", flush=True)
    await server.serve_forever()


asyncio.run(main(Path(sys.argv[1]), *sys.argv[2:]))
