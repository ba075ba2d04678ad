"""Certificates of users with their private keys, in the forms in which people have them, by the package cryptography.

    user_certificates.py FOLDER

writes them: NAME.der and NAME.pem for the certificates; for the keys of "anna" both standards, DER and PEM, and encrypted.
"""

import datetime
import sys
from pathlib import Path

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec, rsa

FORMS = {"der": serialization.Encoding.DER, "pem": serialization.Encoding.PEM}
STANDARDS = {
    "pkcs8": serialization.PrivateFormat.PKCS8,
    "pkcs1": serialization.PrivateFormat.TraditionalOpenSSL,
}


def rsa_key(bits=2048):
    return rsa.generate_private_key(public_exponent=65537, key_size=bits)


def key_bytes(key, form, standard="pkcs8", password=None):
    encryption = serialization.BestAvailableEncryption(password) if password else serialization.NoEncryption()
    return key.private_bytes(FORMS[form], STANDARDS[standard], encryption)


def certificate(name, key, until=2100):
    subject = x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, name)])
    begins = datetime.datetime(2020, 1, 1, tzinfo=datetime.timezone.utc)
    builder = x509.CertificateBuilder(subject, subject, key.public_key(), x509.random_serial_number())
    return builder.not_valid_before(begins).not_valid_after(begins.replace(year=until)).sign(key, hashes.SHA256())


def main(folder):
    anna = rsa_key()
    users = {
        "anna": (anna, 2100),
        "otto": (rsa_key(), 2100),
        "expired": (rsa_key(), 2021),
        "short": (rsa_key(1024), 2100),
        "long": (rsa_key(4096), 2100),
        "curve": (ec.generate_private_key(ec.SECP256R1()), 2100),
    }
    for name, (key, until) in users.items():
        made = certificate(name, key, until)
        for form, encoding in FORMS.items():
            (folder / f"{name}.{form}").write_bytes(made.public_bytes(encoding))
        (folder / f"{name}.key").write_bytes(key_bytes(key, "pem"))
    for form in FORMS:
        for standard in STANDARDS:
            (folder / f"{standard}.{form}").write_bytes(key_bytes(anna, form, standard))
        (folder / f"encrypted.{form}").write_bytes(key_bytes(anna, form, password=b"secret"))
    (folder / "old.pem").write_bytes(key_bytes(anna, "pem", "pkcs1", b"secret"))


main(Path(sys.argv[1]))
